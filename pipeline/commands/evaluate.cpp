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
  const FormatWord word = default_format();
  return {"evaluate",
          "a run over what has ground truth that also scores maps of your own, made by any program",
          running_parameters(
              arguments,
              {{"--maps", &options->maps,
                "folder with ITEM.val (52.val of a mesh, 52_3.val of its scan 3; one value per line), or an "
                "HDF5 file with a data set ITEM",
                true},
               {"--name", &options->name, "what to call them in the tables", true},
               {"--models", &arguments.models, "beside these models only, such as LS,PS"},
               output_parameter(arguments),
               {"--matched", &options->matched, "the values are histogram-matched already"},
               format_parameter(word)}),
          [&arguments, options, word](const std::atomic<bool>& stop) {
            const ReportFormat format = format_of(word);
            Arguments scored = arguments;
            if (scored.items.empty()) scored.items = kScoredItems;
            Session session(scored, stop,
                            given_model(options->name, find_given_maps(options->maps, options->matched)));
            return run_session(session, "evaluate", scored, format);
          }};
}

}  // namespace salbench
