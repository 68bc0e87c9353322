// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/results/costs.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <unordered_map>
#include <utility>

#include "stages/metrics/metrics.h"

namespace salbench {
namespace {

// To the nanosecond, sums included.
double rounded(double seconds) { return std::round(seconds * 1e9) / 1e9; }

struct Cost {
  double seconds = kUndefined, processor_seconds = kUndefined;
};

// The time to read a given map from a file is not reported.
bool is_computed_map(const RunState& run, const Rule& rule) {
  const auto& models = run.config.models;
  const auto model = std::ranges::find(models, rule.subject, &Model::name);
  return has_role(rule, Role::map) && (model == models.end() || !model->given);
}

std::vector<Job> computed_maps(const RunState& run) {
  const Rules& rules = run.project().rules;
  std::vector<Job> maps;
  for (const Unit unit : run.shapes())
    for (std::size_t rule = 0; rule < rules.size(); ++rule)
      if (is_computed_map(run, rules[rule]) && rules[rule].over == unit.level &&
          run.decision({rule, unit}).known())
        maps.push_back({rule, unit});
  return maps;
}

// Adds all direct and indirect inputs; given results cost nothing.
void add_inputs(const Project& project, const Job& job, std::set<Job>& inputs) {
  for (std::size_t i = 0; i < project.rule(job).inputs.size(); ++i)
    for (const Job& input : project.input_jobs(job, i))
      if (!project.rule(input).given && inputs.insert(input).second) add_inputs(project, input, inputs);
}

std::set<Job> inputs_of(const Project& project, const Job& job) {
  std::set<Job> inputs;
  add_inputs(project, job, inputs);
  return inputs;
}

using Costs = std::unordered_map<Digest, Cost>;

Costs read_costs(const RunState& run, const FolderStore& store, const std::vector<Job>& maps) {
  Costs costs;
  for (const Job& map : maps) {
    costs.try_emplace(run.decision(map).key);
    for (const Job& input : inputs_of(run.project(), map)) costs.try_emplace(run.decision(input).key);
  }
  std::vector<Digest> keys;
  for (const auto& [key, cost] : costs) keys.push_back(key);
  store.visit_notes(keys, [&](const Digest& key, const ArtefactNote& note) {
    Cost& cost = costs.at(key);
    if (cost.seconds <= note.seconds) return;  // in two files: the larger, in any order
    cost.seconds = note.seconds;
    const AttributeValue* processor = find_attribute(note.attributes, kProcessorSeconds);
    const double* known = processor == nullptr ? nullptr : std::get_if<double>(processor);
    cost.processor_seconds = known == nullptr ? kUndefined : *known;
  });
  return costs;
}

}  // namespace

Table costs_table(const RunState& run, const FolderStore& store) {
  Table table{
      .columns = {"dataset", "item", "view", "model", "seconds", "processor_seconds", "input_seconds"},
      .rows = {}};
  const std::vector<Job> maps = computed_maps(run);
  const Costs costs = read_costs(run, store, maps);
  for (const Job& map : maps) {
    const Cost& cost = costs.at(run.decision(map).key);
    double of_inputs = 0;
    for (const Job& input : inputs_of(run.project(), map))
      of_inputs += costs.at(run.decision(input).key).seconds;
    table.rows.push_back({std::string(shapes_name(map.unit.level)),
                          item_of(run.units(), map.unit).shape_name(), view_of(run.units(), map.unit),
                          run.project().rule(map).subject, rounded(cost.seconds),
                          rounded(cost.processor_seconds), rounded(of_inputs)});
  }
  return table;
}

}  // namespace salbench
