// SPDX-License-Identifier: GPL-3.0-or-later
// Options as text: parsed from a configuration, with the nearest known word for a misspelled one, and written
// as the canonical lines that enter a cache key.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <fmt/format.h>

#include "stages/core/number.h"
#include "stages/core/options.h"

namespace salbench {

template <class Number>
requires std::is_arithmetic_v<Number>
bool parse_option(std::string_view text, Number& value) {
  const auto number = number_in<Number>(text);
  if constexpr (std::is_floating_point_v<Number>)
    if (number && !std::isfinite(*number)) return false;
  value = number.value_or(value);
  return number.has_value();
}

std::string in_lower_case(std::string_view word);

// "did you mean 'scans'?" with the nearest known word by edit distance, ignoring case; `otherwise` if none is
// near.
std::string did_you_mean(std::string_view word, const std::vector<std::string_view>& known,
                         std::string_view otherwise = {});

// The words of YAML 1.1, as YAML readers of Python accept them.
inline bool parse_option(std::string_view text, bool& value) {
  const std::string word = in_lower_case(text);
  value = word == "true" || word == "yes" || word == "on";
  return value || word == "false" || word == "no" || word == "off";
}

inline bool parse_option(std::string_view text, std::string& value) {
  value = text;
  return true;
}

using Words = std::vector<std::string>;  // names without spaces and commas

template <class Enum>
requires std::is_enum_v<Enum>
bool parse_option(std::string_view text, Enum& value) {
  const auto& names = EnumNames<Enum>::names;
  const auto found = std::find(names.begin(), names.end(), text);
  value = static_cast<Enum>(found - names.begin());
  return found != names.end();
}

template <class Value>
inline constexpr bool kIsByName = false;
template <class Enum>
inline constexpr bool kIsByName<ByName<Enum>> = true;

// Description of the accepted values for an error message; `text` is the value as written.
template <class Value>
std::string expected_of(std::string_view text = {}) {
  if constexpr (std::is_same_v<Value, bool>) return "true or false";
  if constexpr (std::is_floating_point_v<Value>) return "a finite number";
  if constexpr (std::is_integral_v<Value>) {
    if (text.find_first_not_of("0123456789", text.starts_with('-') ? 1 : 0) != std::string_view::npos)
      return std::is_signed_v<Value> ? "a whole number" : "a whole number >= 0";
    using Limits = std::numeric_limits<Value>;
    return fmt::format("a whole number from {} to {}", Limits::min(), Limits::max());
  }
  if constexpr (std::is_enum_v<Value>) {
    std::string list;
    for (const std::string_view name : EnumNames<Value>::names)
      list += (list.empty() ? "" : ", ") + std::string(name);
    return "one of " + list;
  }
  return "a text";
}

std::string yaml_quoted(std::string_view text);  // a scalar that reads back as the same text

std::vector<std::string> lines_in(const std::string& text);
std::string indented(const std::string& lines, std::string_view by);  // puts `by` before each line

// One key with its value, which is already YAML.
struct YamlField {
  YamlField(std::string_view its_key, std::string_view its_value) : key(its_key), value(its_value) {}
  template <std::integral Number>
  YamlField(std::string_view its_key, Number number) : key(its_key), value(std::to_string(number)) {}

  std::string key, value;
};
using YamlFields = std::vector<YamlField>;
std::string yaml_mapping(const YamlFields& fields);  // "{a: 1, b: 2}"; fields without a value are left out

// Plain if it has only letters, digits and the characters of paths; otherwise quoted.
inline std::string yaml_scalar(const std::string& text) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '/' || c == '.';
  };
  return !text.empty() && std::ranges::all_of(text, plain) ? text : yaml_quoted(text);
}

template <class Value>
std::string option_text(const Value& value, bool quoted = false) {
  if constexpr (std::is_enum_v<Value>) {
    return std::string(name_of(value));
  } else if constexpr (kIsByName<Value>) {
    YamlFields fields;
    for (const auto& [name, choice] : value) fields.emplace_back(name, name_of(choice));
    return yaml_mapping(fields);
  } else if constexpr (std::is_same_v<Value, Words>) {
    std::string list;
    for (const std::string& word : value)
      list += (list.empty() ? "" : ", ") + (quoted ? yaml_quoted(word) : word);
    return "[" + list + "]";
  } else if constexpr (std::is_same_v<Value, std::string>) {
    return quoted ? yaml_quoted(value) : yaml_scalar(value);
  } else {
    return fmt::format("{}", value);  // doubles: the shortest text that reads back as the same bits
  }
}

// Meaning, unit, and the values accepted: "support radius (R; > 0)", "how the folder is laid out (a, b)".
template <class Value>
std::string option_note(const OptionHelp& help) {
  std::string accepted = help.range.text();
  if constexpr (std::is_enum_v<Value>) accepted = fmt::format("{}", fmt::join(EnumNames<Value>::names, ", "));
  if constexpr (kIsByName<Value>)
    accepted = fmt::format("{}", fmt::join(EnumNames<typename Value::mapped_type>::names, ", "));
  if (help.unit.empty() && accepted.empty()) return std::string(help.text);
  const char* separator = help.unit.empty() || accepted.empty() ? "" : "; ";
  return fmt::format("{} ({}{}{})", help.text, help.unit, separator, accepted);
}

// One `key: value` per line, in the order of the struct. annotated: the option's note as a comment above each
// line. quoted: texts are quoted, since they may hold YAML syntax.
template <class Options>
std::string options_text(const Options& options, bool annotated = false, bool quoted = false) {
  std::string lines;
  Options::fields(options,
                  [&]<class Value>(std::string_view key, const Value& value, const OptionHelp& help) {
                    if (annotated) lines += fmt::format("# {}\n", option_note<Value>(help));
                    lines += fmt::format("{}: {}\n", key, option_text(value, quoted));
                  });
  return lines;
}

// An option as documentation shows it.
struct OptionRow {
  std::string name;
  std::string value;  // the default; real numbers keep a decimal point ("1.0", never "1")
  std::string note;
};
template <class Options>
std::vector<OptionRow> option_rows(const Options& options) {
  std::vector<OptionRow> rows;
  Options::fields(options,
                  [&]<class Value>(std::string_view key, const Value& value, const OptionHelp& help) {
                    std::string text = option_text(value);
                    if (std::is_floating_point_v<Value> && text.find_first_of(".e") == std::string::npos)
                      text += ".0";
                    rows.push_back({std::string(key), std::move(text), option_note<Value>(help)});
                  });
  return rows;
}

// Text of the options for a key. Options at the values that older keys imply are left out.
template <class Options>
std::string key_text(const Options& options) {
  std::string lines;
  Options::fields(options, [&](std::string_view key, const auto& value, const OptionHelp& help) {
    const std::string text = option_text(value);
    if (text != help.implied) lines += fmt::format("{}: {}\n", key, text);
  });
  return lines;
}

// Defaults as the authors ran them, or as the paper's text says, where the two differ.
enum class Protocol { published, text };
template <>
struct EnumNames<Protocol> {
  static constexpr std::array<std::string_view, 2> names{"published", "text"};
};

template <class Options>
Options preset(Protocol protocol) {
  if constexpr (requires { Options::text(); })
    if (protocol == Protocol::text) return Options::text();
  return Options{};
}

}  // namespace salbench
