// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/explain.h"

#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include "io/table.h"
#include "pipeline/commands/session.h"
#include "pipeline/commands/subcommands.h"
#include "pipeline/config/section.h"
#include "pipeline/plan/causes.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

Item require_item(const Context& context, const std::string& name) {
  if (const auto item = find_item(context, name)) return *item;
  throw ConfigError(
      fmt::format("explain: there is no item '{}'; a shape is named like its file (52), the scans of a mesh "
                  "52_0 to 52_11",
                  name));
}

void require_stage(const Context& context, const std::vector<JobRef>& jobs, const ExplainOptions& options) {
  std::vector<std::string_view> known;
  for (const JobRef& job : jobs) known.push_back(context.row(job).name);
  if (options.stage.empty() || std::find(known.begin(), known.end(), options.stage) != known.end()) return;
  const std::string nearest = nearest_word(options.stage, known);
  throw ConfigError(fmt::format("explain: {} has no stage '{}'; {}", options.item, options.stage,
                                nearest.empty() ? fmt::format("it has {}", fmt::join(known, ", "))
                                                : fmt::format("did you mean '{}'?", nearest)));
}

std::string state_of(const Job& job, const Cause& cause) {
  if (cause.reason == Reason::damaged) return "damaged";
  switch (job.verdict) {
    case Verdict::cached:
    case Verdict::done:
      return "cached";
    case Verdict::compute:
      return "to compute";
    case Verdict::wait:
      return "waiting";
    default:
      return "not applicable";
  }
}

}  // namespace

std::vector<Explanation> explain(const Context& context, const Plan& plan, const std::filesystem::path& cache,
                                 const ExplainOptions& options) {
  const std::vector<JobRef> jobs = jobs_of(context.catalog, require_item(context, options.item));
  require_stage(context, jobs, options);
  Causes causes(context, plan, cache);
  std::vector<Explanation> explanations;
  for (const JobRef& job : jobs) {
    const std::string& stage = context.row(job).name;
    if (!options.stage.empty() && stage != options.stage) continue;
    const Cause cause = causes.of(job, true);
    explanations.push_back({stage, state_of(plan[job], cause), causes.line(job, cause), cause.file});
  }
  return explanations;
}

namespace {

ExitStatus print_explanation(const Arguments& arguments, const ExplainOptions& options) {
  const Setup setup(arguments, {}, Pictures::cached);
  const FolderStore store(setup.cache, Access::read_only);
  const Plan plan = make_plan(setup.context, store);
  const auto explanations = explain(setup.context, plan, setup.cache, options);
  Table table{.columns = {"stage", options.item, "why"}, .rows = {}};
  for (const Explanation& stage : explanations) table.rows.push_back({stage.stage, stage.state, stage.why});
  fmt::print("{}", aligned(table));
  if (!options.stage.empty() && !explanations.front().file.empty())
    fmt::print("{}: {}\n", explanations.front().state == "to compute" ? "nearest" : "artefact",
               explanations.front().file.string());
  return kAllDone;
}

}  // namespace

Subcommand explain_subcommand(Arguments& arguments) {
  const auto options = std::make_shared<ExplainOptions>();
  return {"explain", "tell of each artefact of an item whether it is cached, and if not what differs",
          run_parameters(arguments, {{"ITEM", &options->item,
                                      "a mesh or point cloud (52), or a scan of a mesh (52_3)", true},
                                     {"STAGE", &options->stage, "this stage only"}}),
          [&arguments, options](const std::atomic<bool>&) { return print_explanation(arguments, *options); }};
}

}  // namespace salbench
