// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/report.h"

#include <fmt/format.h>

namespace salbench {

void print_report(const std::string& format, const std::string& subcommand, const Json& members,
                  const std::string& text) {
  if (format != "json") return fmt::print("{}", text);
  Json document = {{"schema", kReportSchema}, {"command", subcommand}};
  document.update(members);
  // U+FFFD in place of bytes that are not UTF-8.
  fmt::print("{}\n", document.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace salbench
