// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/results/results.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "io/file.h"
#include "stages/metrics/score.h"

namespace salbench {

namespace fs = std::filesystem;

// Number of a scan; with separately scored views, preceded by the ground truth's view.
std::string view_of(const Units& units, Unit unit) {
  const std::string& view = item_of(units, unit).view;
  if (unit.level != kScans) return view;
  return fmt::format("{}{}{}", view, view.empty() ? "" : "_", units.place(unit));
}

namespace {

// Rows from the tables of a role. Tables of smoothed maps have several rows per shape: the k-th.
std::vector<ResultRow> collect(const RunState& run, Role role, bool of_constant, std::size_t k = 0) {
  struct Scored {
    std::size_t scores;  // rule whose results the table holds
    ValuePtr table;
    std::size_t shapes = 0;  // shapes consumed so far
  };
  const Rules& rules = run.project().rules;
  std::vector<Scored> scored;
  for (std::size_t r = 0; r < rules.size(); ++r)
    if (has_role(rules[r], role) && (rules[r].subject == kConstantMap) == of_constant)
      scored.push_back({rules[r].inputs[0], run.resolver.value_so_far({r, Unit{}})});

  Metrics metrics = chosen_metrics(run.config.metrics);
  if (of_constant) std::erase_if(metrics, [](const Metric& of) { return !of.constant_varies; });
  const std::size_t rows_per_shape = role == Role::smoothed_table ? run.config.metrics.smoothing.size() : 1;
  std::vector<ResultRow> rows;
  for (const Unit unit : run.shapes())
    for (auto& [rule, table, shapes] : scored) {
      const Job job{rule, unit};
      if (rules[rule].over != unit.level || !run.decision(job).known()) continue;
      const Item& item = item_of(run.units(), unit);
      const std::size_t row = shapes++ * rows_per_shape + k;
      rows.push_back({std::string(shapes_name(unit.level)), item.shape_name(), item.category,
                      view_of(run.units(), unit), rules[rule].subject,
                      in_range(metrics, value_as<ScoreTable>(*table).rows.at(row)), job, item.split});
    }
  return rows;
}

}  // namespace

std::vector<Unit> RunState::shapes() const {
  std::vector<Unit> shapes;
  for (std::size_t family = 0; family < units().families().size(); ++family)
    for (const Unit unit : units().of_family(family))
      if (units().is_chosen(unit) &&
          std::ranges::any_of(project().rules, [&](const Rule& rule) { return rule.level() == unit.level; }))
        shapes.push_back(unit);
  return shapes;
}

std::vector<Job> RunState::known(Role role) const {
  std::vector<Job> jobs;
  for (std::size_t rule = 0; rule < project().rules.size(); ++rule)
    if (has_role(project().rules[rule], role))
      for (const Job& job : project().jobs_of_rule(rule))
        if (decision(job).known()) jobs.push_back(job);
  return jobs;
}

std::vector<ResultRow> collect_results(const RunState& run) { return collect(run, Role::score_table, false); }

std::vector<ResultRow> collect_smoothed(const RunState& run, std::size_t k) {
  return collect(run, Role::smoothed_table, false, k);
}

std::vector<ResultRow> collect_constant(const RunState& run) { return collect(run, Role::score_table, true); }

std::string reference_text(const RunState& run, std::string_view whose) {
  if (std::ranges::any_of(run.project().rules, [](const Rule& rule) { return rule.given != nullptr; }))
    return "given by --reference";
  if (run.inputs.shard) return fmt::format("none, the {} was over a share of the items", whose);
  if (run.known(Role::reference).empty()) return "none";
  return run.inputs.has_others() ? "mean over all items of the data set or split"
                                 : fmt::format("mean over the items of the {}", whose);
}

std::vector<std::string> training_remarks(const RunState& run) {
  std::vector<std::string> remarks;
  for (const Model& model : run.config.models) {
    std::vector<std::string> seen;
    std::size_t scored = 0;
    for (const Family& family : run.units().families()) {
      const Item& item = item_of(family.source);
      if (!family.chosen || !(item.has_truth() || run.config.simulated())) continue;
      ++scored;
      if (std::ranges::any_of(model.trained_on, [&](const std::string& name) {
            return name == item.name || name == item.shape_name() || is_in_split(item.split, name);
          }))
        seen.push_back(item.name);
    }
    if (seen.empty()) continue;
    constexpr std::size_t kNamed = 5;
    const std::string more = seen.size() > kNamed ? fmt::format(" and {} more", seen.size() - kNamed) : "";
    seen.resize(std::min(seen.size(), kNamed));
    remarks.push_back(
        fmt::format("{} was trained on shapes that it is scored on here ({}{}; {} scored): its scores there "
                    "do not say how it does on new shapes.",
                    model.name, fmt::join(seen, ", "), more, scored));
  }
  return remarks;
}

}  // namespace salbench
