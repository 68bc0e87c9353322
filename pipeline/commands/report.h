// SPDX-License-Identifier: GPL-3.0-or-later
// Reports of subcommands: a text for people, and a JSON document for programs. docs/json.md has the
// documents; tests/e2e/json_test.py holds it against them.
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

// An empty optional is null.
template <class T>
struct nlohmann::adl_serializer<std::optional<T>> {
  template <class Json>
  static void to_json(Json& json, const std::optional<T>& value) {
    json = value ? Json(*value) : Json();
  }
};

namespace salbench {

using Json = nlohmann::ordered_json;

// A list of what `convert` makes of each element.
template <class Range, class Convert>
Json list_of(const Range& range, const Convert& convert) {
  Json list = Json::array();
  for (const auto& element : range) list.push_back(convert(element));
  return list;
}

inline constexpr int kReportSchema = 2;  // raised when a key goes, or changes its type or its meaning

// Prints the document of these members, which begins with the schema and the subcommand, where the format is
// "json", and else the text.
void print_report(const std::string& format, const std::string& subcommand, const Json& members,
                  const std::string& text);

}  // namespace salbench
