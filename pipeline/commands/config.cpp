// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/rules/config.h"

#include <fmt/format.h>

#include "pipeline/commands/installed.h"
#include "pipeline/commands/subcommands.h"

namespace salbench {

Subcommand config_subcommand(Arguments& arguments) {
  Parameter file = config_parameter(arguments);
  file.required = false;
  file.help += "; without it, the defaults";
  return {"config",
          "print the complete configuration: every option with its help, unit and range",
          {file},
          [&arguments](const std::atomic<bool>&) {
            const Section written = arguments.config.empty()
                                        ? Section::from_text("", "defaults")
                                        : Section::from_file(configuration_path(arguments.config));
            fmt::print("{}", annotated_config_yaml(read_config(written, "")));
            return kAllDone;
          }};
}

}  // namespace salbench
