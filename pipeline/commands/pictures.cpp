// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "pipeline/commands/run.h"
#include "pipeline/commands/session.h"
#include "pipeline/commands/subcommands.h"

namespace salbench {
namespace {

ExitStatus run_pictures(const Arguments& arguments, ReportFormat format, const std::atomic<bool>& stop) {
  Session session(arguments, stop, {}, Pictures::computed);
  const Project& project = session.setup.project;
  std::vector<std::size_t> pictures;
  for (std::size_t rule = 0; rule < project.rules.size(); ++rule)
    if (has_role(project.rules[rule], Role::picture)) pictures.push_back(rule);
  session.run(thread_count(arguments), "pictures", project.ancestors(pictures));
  if (stop) return interrupted_status(arguments);
  std::size_t computed = 0, known = 0;
  for (const std::size_t rule : pictures) {
    computed += session.resolver.records()[rule].seconds.size();
    for (const Decision& decision : session.resolver.plan().decisions[rule])
      known += decision.known() ? 1U : 0U;
  }
  Json document = {{"pictures", known}};
  document.update(summary_of(session));
  print_report(format, "pictures", document,
               arguments.quiet ? ""
                               : fmt::format("{} pictures in {}, {} of them computed now; `salbench export` "
                                             "contains them\n",
                                             known, session.setup.cache.string(), computed));
  return finished_status(session);
}

}  // namespace

Subcommand pictures_subcommand(Arguments& arguments) {
  const FormatWord word = default_format();
  return {"pictures", "compute pictures of all shapes for reports; export then contains them",
          // no picture shows a matched map
          without(running_parameters(arguments, {format_parameter(word)}), {"--reference"}),
          [&arguments, word](const std::atomic<bool>& stop) {
            return run_pictures(arguments, format_of(word), stop);
          }};
}

}  // namespace salbench
