// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/report.h"

#include <fmt/format.h>

#include "pipeline/config/option_text.h"
#include "stages/core/errors.h"

namespace salbench {

FormatWord default_format() { return std::make_shared<std::string>(name_of(ReportFormat::text)); }

Parameter format_parameter(const FormatWord& word, const std::string& further_help) {
  return {"--format", word.get(),
          "text (default), or json: one document for programs (docs/json.md)" + further_help};
}

ReportFormat format_of(const FormatWord& word, bool graph, std::string_view option) {
  ReportFormat format{};
  if (parse_option(*word, format) && (graph || format != ReportFormat::dot)) return format;
  throw ConfigError(
      fmt::format("{} {}: must be {}", option, *word, graph ? "text, json or dot" : "text or json"));
}

Json rows_json(const Table& table) {
  const Table texts = parse_csv(to_csv(table), "table");
  return list_of(texts.rows, [&](const std::vector<Cell>& row) {
    Json object;
    for (std::size_t column = 0; column < row.size(); ++column)
      object[texts.columns[column]] = std::get<std::string>(row[column]);
    return object;
  });
}

void print_report(ReportFormat format, const std::string& subcommand, const Json& members,
                  const std::string& text) {
  if (format != ReportFormat::json) return fmt::print("{}", text);
  Json document = {{"schema", kReportSchema}, {"command", subcommand}};
  document.update(members);
  // U+FFFD in place of bytes that are not UTF-8.
  fmt::print("{}\n", document.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace salbench
