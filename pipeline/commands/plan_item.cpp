// SPDX-License-Identifier: GPL-3.0-or-later
// The plan of one item: the state of each of its stages, and why. For one stage also its key, and lines by
// which its recipe differs from each that the cache has of this stage and item: "- before", "+ now".
#include <algorithm>
#include <sstream>

#include <fmt/format.h>

#include "cache/recipes.h"
#include "io/table.h"
#include "pipeline/commands/plan.h"
#include "pipeline/commands/report.h"
#include "pipeline/results/counts.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

std::vector<std::string> lines_of(const Recipe& recipe) {
  std::istringstream text(fmt::format("version: {}\n{}{}{}", recipe.stage_version, recipe.options,
                                      recipe.seed.empty() ? "" : fmt::format("seed: {}\n", recipe.seed),
                                      inputs_text(recipe)));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

std::string lines_without(const Recipe& recipe, const Recipe& other, std::string_view sign) {
  const std::vector<std::string> known = lines_of(other);
  std::string text;
  for (const std::string& line : lines_of(recipe))
    if (std::ranges::find(known, line) == known.end()) text += fmt::format("  {} {}\n", sign, line);
  return text;
}

// A mesh may be called "52_3", as the scan 3 of the mesh 52 is: it goes first.
std::vector<Job> require_jobs(const Project& project, const std::string& item, const std::string& stage) {
  for (const Level level : {kMeshes, kClouds, kScans})
    for (const Unit unit : project.units.of(level)) {
      if (project.units.name(unit) != item) continue;
      std::vector<Job> jobs = project.jobs_of(unit);
      std::erase_if(jobs, [&](const Job& job) { return !stage.empty() && project.rule(job).stage != stage; });
      if (!jobs.empty()) return jobs;
    }
  throw ConfigError(
      fmt::format("plan: there is no item '{}'{}; a shape is named like its file (52), the "
                  "scans of a mesh 52_0 to 52_11",
                  item, stage.empty() ? "" : fmt::format(" with a stage '{}'", stage)));
}

}  // namespace

ExitStatus print_plan_of_item(const Arguments& arguments, const std::string& item, const std::string& stage) {
  const Setup setup(arguments, Pictures::cached);
  const FolderStore store(setup.cache, Access::read_only);
  const Project& project = setup.project;
  const std::vector<Job> jobs = require_jobs(project, item, stage);
  const Plan plan = make_plan_of(project, store, jobs);
  Table table{.columns = {"stage", item, "why"}, .rows = {}};
  Json stages = Json::array();
  for (const Job& job : jobs) {
    const std::string state = state_of(plan[job]), why = why_of(project, plan, job);
    table.rows.push_back({project.rule(job).stage, state, why});
    stages.push_back({{"stage", project.rule(job).stage}, {"state", state}, {"why", why}});
  }
  std::string text = aligned(table);
  if (!stage.empty() && plan[jobs[0]].key != Digest()) {
    const Recipe now = recipe_of(project, plan, jobs[0]);
    text += fmt::format("key {}\n", plan[jobs[0]].key.hex());
    for (const KnownArtefact& known : known_recipes(setup.cache, project.family(jobs[0]), stage, item))
      text += fmt::format("{}: key {}\n{}{}", known.file.string(), known.key.hex(),
                          lines_without(*known.recipe, now, "-"), lines_without(now, *known.recipe, "+"));
  }
  print_report(arguments.format, "item", {{"item", item}, {"stages", stages}}, text);
  return kAllDone;
}

}  // namespace salbench
