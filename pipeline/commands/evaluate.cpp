// SPDX-License-Identifier: GPL-3.0-or-later
#include <memory>

#include "pipeline/commands/run.h"
#include "pipeline/commands/subcommands.h"

namespace salbench {

Subcommand evaluate_subcommand(Arguments& arguments) {
  struct Options {
    std::string maps, name;
    bool matched = false;
  };
  const auto options = std::make_shared<Options>();
  const FormatWord format = default_format();
  return {"evaluate", "a run that also scores saliency maps of your own, made by any program",
          run_parameters(
              arguments,
              {{"--maps", &options->maps,
                "folder with ITEM.val (52.val of a mesh, 52_3.val of its scan 3; one value per line), or an "
                "HDF5 file with a data set ITEM",
                true},
               {"--name", &options->name, "what to call them in the tables", true},
               {"--models", &arguments.models, "beside these models only, such as LS,PS"},
               {"--matched", &options->matched, "the values are histogram-matched already"},
               format_parameter(format)}),
          [&arguments, options, format](const std::atomic<bool>& stop) {
            const ReportFormat chosen = format_of(format);
            Session session(arguments, stop,
                            given_model(options->name, find_given_maps(options->maps, options->matched)));
            return run_session(session, arguments, chosen, "evaluate");
          }};
}

}  // namespace salbench
