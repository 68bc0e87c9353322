// SPDX-License-Identifier: GPL-3.0-or-later
// This folder: options as text. A YAML file comes in; option structs go out, whose fields say how they are
// named, written and checked (stages/core/options.h), together with the lines that enter a key. It includes
// io/ and stages/, and is the only folder that uses yaml-cpp.
//
// Section is one mapping of such a file. Every error names file, line and key.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/config/option_text.h"
#include "stages/core/errors.h"
#include "stages/core/options.h"

namespace salbench {

inline constexpr std::string_view kEveryName = "all";

// Collects the errors of a file, so that all are reported at once, up to a limit.
class SectionErrors {
 public:
  explicit SectionErrors(std::size_t most = 100) : most_(most) {}

  // Runs the body and keeps a SectionError that it throws. Does nothing once the limit is reached.
  template <class Body>
  void gather(const Body& body) {
    if (errors_.size() == most_) return;
    try {
      body();
    } catch (const SectionError& error) {
      errors_.push_back(error);
    }
  }
  bool any() const { return !errors_.empty(); }
  void throw_any() const;  // one SectionError with a line for each error, in the file's order

 private:
  std::size_t most_;
  std::vector<SectionError> errors_;
};

// Record of a run, itself a configuration; and the first words of the record of an unfinished run.
inline constexpr const char* kRecord = "run.yaml";
inline constexpr std::string_view kUnderWay = "# a run is under way, or was ended before its end\n";
bool is_record_text(std::string_view text);

class Section {
 public:
  // Root mapping of a file. Throws ConfigError: unreadable, not YAML, not a mapping, duplicate key.
  static Section from_file(const std::string& path);
  static Section from_text(const std::string& yaml, const std::string& name);

  std::vector<std::string> keys() const;  // in the file's order
  bool has(std::string_view key) const;
  Section child(std::string_view key) const;                    // a mapping; a bare `key:` is an empty one
  std::optional<std::string> text(std::string_view key) const;  // scalar as written; nullopt if absent
  Section child_or_names(std::string_view key) const;           // `[a, b]` is read as `{a: , b: }`
  bool has_mapping(std::string_view key) const;                 // true for a bare `key:` as well
  std::vector<Section> list(std::string_view key) const;        // list of mappings, or a single one
  Words words(std::string_view key) const;                      // list of scalars, or a single one
  // Copies of this section, one per combination of the values that `key` lists for each option; the last
  // option varies fastest. `key` itself is replaced. Throws ConfigError for more than `most` combinations.
  std::vector<Section> combinations(std::string_view key, std::size_t most) const;

  std::string folder() const;                         // base of relative paths in the section
  Section as_if_in(const std::string& folder) const;  // the same section with another base folder
  std::string where(std::string_view key) const;      // "file:line"
  [[noreturn]] void fail(std::string_view key, std::string_view what) const;  // "file:line: path.key what"
  void reject_unknown(const std::vector<std::string_view>& known) const;      // for each; suggests the
                                                                              // nearest known key

  template <class Value>
  void read_value(std::string_view key, Value& value) const {
    const auto written = text(key);
    if (!written) return;
    if (!parse_option(*written, value))
      fail(key, "is '" + *written + "', not " + expected_of<Value>(*written));
  }
  void read_value(std::string_view key, Words& value) const {
    if (has(key)) value = words(key);
  }
  template <class Enum>  // a mapping by name, or a single value, stored under kEveryName
  void read_value(std::string_view key, ByName<Enum>& value) const {
    if (!has(key)) return;
    value.clear();
    if (!has_mapping(key)) return read_value(key, value[std::string(kEveryName)]);
    const Section named = child(key);
    SectionErrors errors;
    for (const std::string& name : named.keys()) errors.gather([&] { named.read_value(name, value[name]); });
    errors.throw_any();
  }

  // Overwrites the fields that the section names; others keep their defaults. beside: further allowed keys.
  template <class Options>
  void read(Options& options, const std::vector<std::string_view>& beside = {}) const {
    SectionErrors errors;
    std::vector<std::string_view> known;
    Options::fields(options, [&]<class Value>(std::string_view key, Value& value, const OptionHelp& help) {
      known.push_back(key);
      errors.gather([&] {
        read_value(key, value);
        if constexpr (std::is_arithmetic_v<Value> && !std::is_same_v<Value, bool>)
          checked([&] { check_range(key, static_cast<double>(value), help.range); });
      });
    });
    known.insert(known.end(), beside.begin(), beside.end());
    errors.gather([&] { reject_unknown(known); });
    errors.throw_any();
    checked([&] { check(options); });
  }

 private:
  template <class Check>
  void checked(const Check& check) const {
    try {
      check();
    } catch (const OptionError& error) {
      fail(error.key, error.what_is_wrong);
    }
  }

  struct Impl;
  explicit Section(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}
  std::shared_ptr<const Impl> impl_;
};

}  // namespace salbench
