// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "io/file.h"
#include "pipeline/commands/interrupt.h"
#include "pipeline/commands/session.h"
#include "pipeline/commands/subcommands.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

std::string val_text(const ScalarField& field) {
  std::string lines;
  for (const double value : field) lines += fmt::format("{}\n", value);
  return lines;
}

// Writes TO/MODEL/ITEM.val for every map that is known; returns how many. Ends early once `stop` is set.
std::size_t write_maps(Session& session, const fs::path& folder, std::string_view kind,
                       const std::atomic<bool>& stop) {
  const Context& context = session.setup.context;
  for (const Model& model : session.setup.config.models)
    if (model.is_map()) make_folder(folder / model.name, "choose another with --to");
  const std::vector<Item> items = all_items(context);
  std::size_t written = 0;
  session.progress->begin("writing", items.size());
  for (const Item& item : items) {
    for (const JobRef& job : jobs_of(context.catalog, item)) {
      if (stop) return written;
      const std::string& name = context.row(job).name;
      if (!name.starts_with(kind) || !session.plan[job].known()) continue;
      const ValuePtr map = session.runner.result(job);
      write_file(folder / name.substr(kind.size()) / (context.name(item) + ".val"),
                 val_text(std::get<ScalarField>(*map)));
      ++written;
    }
    session.progress->item_done();
  }
  session.progress->end();
  return written;
}

ExitStatus run_maps(const Arguments& arguments, bool matched, const std::atomic<bool>& stop) {
  Session session(arguments, stop);
  const OrderlyEnd orderly;
  session.runner.run(thread_count(arguments));
  if (stop) return interrupted_status(arguments);
  const std::size_t written = write_maps(session, arguments.to, matched ? "matched." : "map.", stop);
  if (stop) return interrupted_status(arguments);
  if (!arguments.quiet) fmt::print("{} maps written to {}\n", written, arguments.to);
  return finished_status(session);
}

}  // namespace

Subcommand maps_subcommand(Arguments& arguments) {
  const auto matched = std::make_shared<bool>(false);
  return {
      "maps", "compute saliency maps and write TO/MODEL/ITEM.val, one value per line",
      run_parameters(arguments, {{"--models", &arguments.models, "only these, such as LS,PS"},
                                 {"--to", &arguments.to, "folder that the maps are written to", true},
                                 {"--matched", matched.get(), "after histogram matching"}}),
      [&arguments, matched](const std::atomic<bool>& stop) { return run_maps(arguments, *matched, stop); }};
}

}  // namespace salbench
