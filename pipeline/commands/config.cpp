// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/rules/config.h"

#include <memory>

#include "pipeline/commands/cli.h"
#include "pipeline/commands/report.h"

namespace salbench {

Action config_subcommand(CLI::App& program) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& app = add_subcommand(
      program, "config", "print the complete configuration: every option with its help, unit and range",
      {{"config", "every option, its default, unit and range"},
       {"config shrec07", "a configuration with all that it leaves out"}});
  CLI::Option* config = add_config(app, *arguments)->required(false);
  config->description(config->get_description() + "; without it, the defaults");
  add_format(app, *arguments);
  return [arguments] {
    const Section written =
        arguments->config.empty() ? Section::from_text("", "defaults") : configuration(arguments->config);
    const std::string yaml = annotated_config_yaml(read_config(written, ""));
    print_report(arguments->format, "config", {{"yaml", yaml}}, yaml);
    return kAllDone;
  };
}

}  // namespace salbench
