#include "pipeline/explain.h"

#include <fmt/format.h>

#include "io/table.h"
#include "pipeline/section.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

ItemRef find_item(const Context& context, const std::string& name) {
  for (const bool meshes : {true, false})  // a mesh may be called like a scan
    for (const ItemRef& item : context.items(meshes))
      if (context.name(item) == name) return item;
  throw ConfigError(fmt::format(
      "explain: there is no item '{}'; a mesh is named like its file (52), its scans 52_0 to 52_11", name));
}

void require_stage(const Chain& chain, const std::string& item, const std::string& name) {
  if (has_stage(chain, name)) return;
  std::vector<std::string_view> known;
  for (const Stage& stage : chain) known.push_back(stage.name);
  const std::string nearest = nearest_word(name, known);
  throw ConfigError(fmt::format("explain: {} has no stage '{}'; {}", item, name,
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
  const ItemRef item = find_item(context, options.item);
  const Chain& chain = context.chain(item);
  if (!options.stage.empty()) require_stage(chain, options.item, options.stage);
  Causes causes(context, plan, cache);
  std::vector<Explanation> explanations;
  for (std::size_t s = 0; s < chain.size(); ++s) {
    if (!options.stage.empty() && chain[s].name != options.stage) continue;
    const Cause cause = causes.of(item, s, true);
    explanations.push_back(
        {chain[s].name, state_of(plan.jobs(item)[s], cause), causes.line(item, s, cause), cause.file});
  }
  return explanations;
}

ExitStatus explain_command(const Arguments& arguments, const ExplainOptions& options) {
  const Setup setup(arguments);
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

}  // namespace salbench
