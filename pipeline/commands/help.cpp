// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/help.h"

#include <fmt/format.h>

namespace salbench {

std::string help_footer() {
  constexpr std::size_t kWidth = 104;
  std::string text = "Examples:\n";
  for (const Example& example : kExamples)
    text += *example.remark == '\0' ? fmt::format("  {}\n", example.line)
                                    : fmt::format("  {:<64}{}\n", example.line, example.remark);
  std::string line = "\nExit status:";
  for (const StatusMeaning& row : kStatusMeanings) {
    const bool last = &row == &kStatusMeanings.back();
    const std::string words = fmt::format("{} {}{}", row.status, row.meaning, last ? "." : ";");
    if (line.size() + 1 + words.size() > kWidth) {
      text += line + "\n";
      line = words;
    } else {
      line += " " + words;
    }
  }
  return text + line;
}

}  // namespace salbench
