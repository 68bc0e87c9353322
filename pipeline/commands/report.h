// SPDX-License-Identifier: GPL-3.0-or-later
// Reports of subcommands: facts in a struct, from which both the text for people and the JSON document for
// programs are made. docs/json.md has the documents; tests/e2e/json_test.py holds it against them.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "io/table.h"
#include "pipeline/commands/subcommand.h"
#include "stages/core/options.h"

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

inline constexpr int kReportSchema = 1;  // raised when a key goes, or changes its type or its meaning

enum class ReportFormat { text, json, dot };
template <>
struct EnumNames<ReportFormat> {
  static constexpr std::array<std::string_view, 3> names{"text", "json", "dot"};
};

// --format as it is typed, which lives as long as its subcommand.
using FormatWord = std::shared_ptr<std::string>;
FormatWord default_format();
Parameter format_parameter(const FormatWord& word, const std::string& further_help = "");

// Throws ConfigError for another word than text and json, and dot for Graphviz if there is a graph.
ReportFormat format_of(const FormatWord& word, bool graph = false, std::string_view option = "--format");

// The rows of a table; cells are texts as its CSV file has them.
Json rows_json(const Table& table);

// Prints the document of these members, which begins with the schema and the subcommand, or else the text.
void print_report(ReportFormat format, const std::string& subcommand, const Json& members,
                  const std::string& text);

}  // namespace salbench
