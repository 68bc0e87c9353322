// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/rules/config.h"

#include <fmt/format.h>

#include "pipeline/commands/installed.h"
#include "pipeline/commands/report.h"
#include "pipeline/commands/subcommands.h"

namespace salbench {

Subcommand config_subcommand(Arguments& arguments) {
  const FormatWord word = default_format();
  Parameter file = config_parameter(arguments);
  file.required = false;
  file.help += "; without it, the defaults";
  return {"config",
          "print the complete configuration: every option with its help, unit and range",
          {file, format_parameter(word)},
          [&arguments, word](const std::atomic<bool>&) {
            const ReportFormat format = format_of(word);
            const Section written = arguments.config.empty() ? Section::from_text("", "defaults")
                                                             : configuration(arguments.config);
            const std::string yaml = annotated_config_yaml(read_config(written, ""));
            print_report(format, "config", {{"yaml", yaml}}, yaml);
            return kAllDone;
          }};
}

}  // namespace salbench
