// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/run/plan.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "cache/recipes.h"
#include "pipeline/engine/run.h"
#include "pipeline/inputs/inputs.h"
#include "pipeline/rules/rules.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

// One row per stage of the run, then stages that only the cache has, from other configurations.
std::vector<StagePlan> stage_plans(const std::vector<StageCount>& counts, const FolderStore& store) {
  std::map<std::string, FolderStore::Usage> usage;
  for (const FolderStore::Usage& used : store.usage()) usage[used.stage] = used;
  std::vector<StagePlan> plans;
  const auto add = [&](const StageCount& count) {
    const FolderStore::Usage used = usage[count.stage];
    usage.erase(count.stage);
    plans.push_back({count, used.artefacts, used.bytes});
  };
  for (const StageCount& count : counts) add(count);
  for (const FolderStore::Usage& used : store.usage())
    if (usage.contains(used.stage)) add({.stage = used.stage});
  return plans;
}

// --- one item ---------------------------------------------------------------------------------------------

std::vector<std::string> lines_of(const Recipe& recipe) {
  return lines_in(fmt::format("version: {}\n{}{}{}", recipe.stage_version, recipe.options,
                              recipe.seed.empty() ? "" : fmt::format("seed: {}\n", recipe.seed),
                              inputs_text(recipe)));
}

std::vector<std::string> lines_without(const Recipe& recipe, const Recipe& other) {
  std::vector<std::string> lines = lines_of(recipe);
  const std::vector<std::string> known = lines_of(other);
  std::erase_if(lines,
                [&](const std::string& line) { return std::ranges::find(known, line) != known.end(); });
  return lines;
}

// A mesh named "52_3" takes precedence over scan 3 of mesh 52.
std::vector<Job> require_jobs(const Project& project, const std::string& item, const std::string& stage) {
  std::vector<std::string> stages_of_item;
  for (const Level level : {kMeshes, kClouds, kScans})
    for (const Unit unit : project.units.of(level)) {
      if (project.units.name(unit) != item) continue;
      std::vector<Job> jobs = project.jobs_of(unit);
      for (const Job& job : jobs) stages_of_item.push_back(project.rule(job).stage);
      std::erase_if(jobs, [&](const Job& job) { return !stage.empty() && project.rule(job).stage != stage; });
      if (!jobs.empty()) return jobs;
    }
  if (!stages_of_item.empty())
    throw ConfigError(fmt::format("plan: {} has no stage '{}'; {}", item, stage,
                                  did_you_mean(stage, {stages_of_item.begin(), stages_of_item.end()},
                                               fmt::format("it has {}", fmt::join(stages_of_item, ", ")))));
  throw ConfigError(fmt::format(
      "plan: there is no item '{}'; a shape is named like its file (52), the scans of a mesh 52_0 to 52_11",
      item));
}

// --- the graph --------------------------------------------------------------------------------------------

std::vector<std::string> option_lines(const Rule& rule) {
  std::vector<std::string> lines;
  for (const OptionLines& options : rule.options)
    std::ranges::move(lines_in(options.text), std::back_inserter(lines));
  return lines;
}

}  // namespace

PlannedRun::PlannedRun(const Request& request, const Front& front)
    : setup(request, front), store(setup.cache, Access::read_only), plan(make_plan(setup.project, store)) {
  const std::vector<StageCount> counts = count_by_stage(setup.project, plan, Counted::open);
  own_stages = counts.size();
  stages = stage_plans(counts, store);
}

std::size_t PlannedRun::open() const {
  std::size_t open = 0;
  for (const StagePlan& stage : stages) open += stage.count.compute + stage.count.wait;
  return open;
}

ItemPlan plan_of_item(const Request& request, const Front& front, const std::string& item,
                      const std::string& stage) {
  Request with_pictures = request;
  with_pictures.pictures = Pictures::cached;
  const Setup setup(with_pictures, front);
  const FolderStore store(setup.cache, Access::read_only);
  const Project& project = setup.project;
  const std::vector<Job> jobs = require_jobs(project, item, stage);
  const Plan plan = make_plan_of(project, store, jobs);
  ItemPlan planned;
  for (const Job& job : jobs)
    planned.stages.push_back({project.rule(job).stage, state_of(plan[job]), why_of(project, plan, job)});
  if (stage.empty() || plan[jobs[0]].key == Digest()) return planned;
  const Recipe now = recipe_of(project, plan, jobs[0]);
  planned.key = plan[jobs[0]].key.hex();
  for (const KnownArtefact& known : known_recipes(setup.cache, project.family(jobs[0]), stage, item))
    planned.others.push_back(
        {known.file, known.key.hex(), lines_without(*known.recipe, now), lines_without(now, *known.recipe)});
  return planned;
}

Graph graph_of(const Rules& rules) {
  const std::vector<std::size_t> stratum = strata(rules);
  Graph graph;
  for (std::size_t r = 0; r < rules.size(); ++r) {
    const Rule& rule = rules[r];
    graph.push_back({.name = node_name(rule),
                     .stage = rule.stage,
                     .shapes = shapes_name(rule.over),
                     .per = levels()[rule.level()].unit,
                     .version = rule.version,
                     .options = option_lines(rule),
                     .stratum = stratum[r]});
    for (const std::size_t input : rule.inputs) {
      graph[r].inputs.push_back(graph[input].name);
      if (stratum[input] < stratum[r]) graph[r].cuts.push_back(graph[input].name);
    }
  }
  return graph;
}

Graph graph_of_run(const Request& request, const Front& front) {
  const Config config = config_of(request, front);
  const bool of_data = request.split || !request.items.all() || request.reference ||
                       request.reference_of_items || !(config.data + request.cache + request.shard).empty();
  if (!of_data) return graph_of(make_rules(config, {}, {}, front));
  const PlannedRun run(request, front);
  Graph graph = graph_of(run.setup.project.rules);
  for (std::size_t rule = 0; rule < graph.size(); ++rule) graph[rule].to_do = run.plan.open(rule);
  return graph;
}

}  // namespace salbench
