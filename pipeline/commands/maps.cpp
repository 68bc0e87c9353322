// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "io/file.h"
#include "pipeline/commands/interrupt.h"
#include "pipeline/commands/run.h"
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
std::size_t write_maps(Session& session, const fs::path& folder, Role role, const std::atomic<bool>& stop) {
  const RunState run = session.state();
  for (const Model& model : session.setup.config.models)
    if (model.add_map) make_folder(folder / model.name, "choose another with --to");
  const std::vector<Unit> shapes = run.shapes();
  std::size_t written = 0;
  session.progress->begin("writing", shapes.size());
  for (const Unit shape : shapes) {
    for (const Job& job : run.project().jobs_of(shape)) {
      if (stop) return written;
      const Rule& rule = run.project().rule(job);
      if (!has_role(rule, role) || !run.decision(job).known()) continue;
      const ValuePtr map = run.resolver.value(job);
      write_file(folder / rule.subject / (run.units().name(shape) + ".val"),
                 val_text(value_as<ScalarField>(*map)));
      ++written;
    }
    session.progress->item_done();
  }
  session.progress->end();
  return written;
}

ExitStatus run_maps(const Arguments& arguments, bool matched, ReportFormat format,
                    const std::atomic<bool>& stop) {
  Session session(arguments, stop);
  const OrderlyEnd orderly;
  session.run(thread_count(arguments));
  if (stop) return interrupted_status(arguments);
  const std::size_t written = write_maps(session, arguments.to, matched ? Role::matched : Role::map, stop);
  if (stop) return interrupted_status(arguments);
  Json document = {{"to", arguments.to}, {"written", written}};
  document.update(summary_of(session));
  print_report(format, "maps", document,
               arguments.quiet ? "" : fmt::format("{} maps written to {}\n", written, arguments.to));
  return finished_status(session);
}

}  // namespace

Subcommand maps_subcommand(Arguments& arguments) {
  const auto matched = std::make_shared<bool>(false);
  const FormatWord word = default_format();
  return {"maps", "compute saliency maps and write TO/MODEL/ITEM.val, one value per line",
          running_parameters(arguments, {{"--models", &arguments.models, "only these, such as LS,PS"},
                                         {"--to", &arguments.to, "folder that the maps are written to", true},
                                         {"--matched", matched.get(), "after histogram matching"},
                                         format_parameter(word)}),
          [&arguments, matched, word](const std::atomic<bool>& stop) {
            return run_maps(arguments, *matched, format_of(word), stop);
          }};
}

}  // namespace salbench
