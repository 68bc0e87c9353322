// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/results/smoothing.h"

#include <cmath>

#include "pipeline/results/raw_tables.h"
#include "pipeline/results/table_rows.h"
#include "stages/stats/summary.h"

namespace salbench {
namespace {

// The better of two scores; the other one where one is undefined.
double better(double a, double b, bool higher_is_better) {
  return higher_is_better ? std::fmax(a, b) : std::fmin(a, b);
}

// All have the same shapes and models, in the same order.
std::vector<ResultRow> best_of(const std::vector<SmoothedRows>& smoothed, const Metrics& metrics) {
  std::vector<ResultRow> best = smoothed.front().rows;
  for (const SmoothedRows& other : smoothed)
    for (std::size_t row = 0; row < best.size(); ++row)
      for (std::size_t m = 0; m < metrics.size(); ++m) {
        double& value = best[row].scores.values.at(m);
        value = better(value, other.rows.at(row).value(m), metrics[m].higher_is_better);
      }
  return best;
}

// One part of the data set, by number of steps.
void add_rows(Table& table, const std::vector<SmoothedRows>& smoothed,
              const std::vector<DatasetScores>& by_steps, const Metrics& metrics) {
  for (std::size_t model = 0; model < by_steps[0].models().size(); ++model)
    for (std::size_t m = 0; m < metrics.size(); ++m)
      for (std::size_t k = 0; k < by_steps.size(); ++k) {
        const UnitScores scores = by_steps[k].compared(m, {&model, 1});
        const Summary summary = summarise(scores.scores.values);
        table.rows.push_back(cells(by_steps[k].label(), by_steps[k].models()[model], metrics[m].name,
                                   smoothed[k].steps, summary.n, scores.n_shapes, summary.mean,
                                   student_interval(summary), smoothed[k].steps == kBestSteps ? 1 : 0));
      }
}

}  // namespace

std::vector<SmoothedRows> smoothed_rows(const RunState& run, const Metrics& metrics) {
  std::vector<SmoothedRows> smoothed;
  for (const std::string& steps : run.config.metrics.smoothing)
    smoothed.push_back({steps, collect_smoothed(run, smoothed.size())});
  if (!smoothed.empty()) smoothed.push_back({kBestSteps, best_of(smoothed, metrics)});
  return smoothed;
}

Table smoothing_table(const std::vector<SmoothedRows>& smoothed, const Metrics& metrics, Observation unit) {
  Table table{.columns = {"dataset", "model", "metric", "steps", "n", "n_shapes", "mean", "ci95_low",
                          "ci95_high", "upper_bound"},
              .rows = {}};
  const std::vector<ResultRow>& rows = smoothed.front().rows;
  if (any_in_splits(rows)) table.columns.insert(table.columns.begin() + 1, "split");
  for (const std::string_view dataset : kShapeNames) {
    std::vector<std::string> splits = splits_among(rows, dataset);
    splits.insert(splits.begin(), "");
    for (const std::string& split : splits) {
      std::vector<DatasetScores> by_steps;
      for (const SmoothedRows& some : smoothed) by_steps.emplace_back(some.rows, dataset, unit, "", split);
      add_rows(table, smoothed, by_steps, metrics);
    }
  }
  return table;
}

}  // namespace salbench
