// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/quality/calibration.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "pipeline/results/pairs.h"
#include "stages/core/rng.h"
#include "stages/stats/summary.h"

namespace salbench {
namespace {

// Mean over the units of the variance within them, and variance of their means.
struct Spread {
  double within = 0, between = 0;
};

Spread spread(const std::vector<std::vector<double>>& units) {
  Spread found;
  std::vector<double> means;
  double squares = 0, freedom = 0;
  for (const std::vector<double>& unit : units) {
    const Summary summary = summarise(unit);
    means.push_back(summary.mean);
    if (unit.size() < 2) continue;
    squares += summary.sd * summary.sd * static_cast<double>(unit.size() - 1);
    freedom += static_cast<double>(unit.size() - 1);
  }
  found.within = freedom > 0 ? squares / freedom : 0;
  found.between = std::pow(summarise(means).sd, 2);
  return found;
}

double deviation(double variance) { return std::sqrt(std::max(variance, 0.0)); }

// The numbers of a column, empty cells left out.
std::vector<double> numbers(const Table& table, std::string_view column) {
  const auto at = static_cast<std::size_t>(std::ranges::find(table.columns, column) - table.columns.begin());
  std::vector<double> found;
  for (const std::vector<Cell>& row : table.rows) {
    if (const auto* whole = std::get_if<std::int64_t>(&row.at(at)))
      found.push_back(static_cast<double>(*whole));
    if (const auto* real = std::get_if<double>(&row.at(at))) found.push_back(*real);
  }
  return found;
}

class Rates {
 public:
  void add(const std::string& what, double expected, bool hit) {
    auto found = std::ranges::find(rates_, what, &Rate::what);
    if (found == rates_.end()) found = rates_.insert(rates_.end(), {what, expected});
    found->hits += hit ? 1 : 0;
    ++found->cases;
  }
  void add_intervals(const std::string& what, const Table& table, const std::string& ends, double truth) {
    const std::vector<double> low = numbers(table, ends + "_low"), high = numbers(table, ends + "_high");
    for (std::size_t i = 0; i < low.size(); ++i) add(what, kConfidence, low[i] <= truth && truth <= high[i]);
  }
  void add_tests(const std::string& what, const Table& table, const std::string& column) {
    for (const double p : numbers(table, column)) add(what, 1 - kConfidence, p < 1 - kConfidence);
  }
  std::vector<Rate> take() { return std::move(rates_); }

 private:
  std::vector<Rate> rates_;
};

// Rows of one metric, whose values are drawn anew for each data set.
class SimulatedScores {
 public:
  explicit SimulatedScores(const ScoreModel& model) : model_(model) {
    for (std::size_t mesh = 0; mesh < model.meshes; ++mesh)
      for (std::size_t view = 0; view < model.views; ++view)
        for (std::size_t m = 0; m < model.models; ++m)
          rows_.push_back(
              {"scans", std::to_string(mesh), "", std::to_string(view), fmt::format("M{}", m), {{0.0}}});
  }

  // The first model is better by `ahead`.
  const std::vector<ResultRow>& draw(Rng& rng, double ahead = 0) {
    std::size_t row = 0;
    std::vector<double> of_mesh(model_.models);
    for (std::size_t mesh = 0; mesh < model_.meshes; ++mesh) {
      const double shared = model_.mesh * rng.normal();
      for (double& own : of_mesh) own = shared + model_.model_of_mesh * rng.normal();
      of_mesh[0] += ahead;
      for (std::size_t view = 0; view < model_.views; ++view) {
        const double of_view = model_.view * rng.normal();
        for (const double own : of_mesh)
          rows_[row++].scores.values[0] = own + of_view + model_.model_of_view * rng.normal();
      }
    }
    return rows_;
  }

  // Of the mean difference of two models.
  double standard_error() const {
    const auto meshes = static_cast<double>(model_.meshes), views = static_cast<double>(model_.views);
    return std::sqrt(2 * (std::pow(model_.model_of_mesh, 2) + std::pow(model_.model_of_view, 2) / views) /
                     meshes);
  }

 private:
  ScoreModel model_;
  std::vector<ResultRow> rows_;
};

const Metrics kOneMetric{{.name = "score", .unit = "", .help = "", .value = nullptr}};

void add_equal_models(Rates& rates, const std::vector<ResultRow>& rows, std::uint64_t seed) {
  const Conclusions conclusions = conclude(rows, kOneMetric, {}, seed);
  const Table summary = summary_table(conclusions), pairs = significance_table(conclusions),
              ranking = ranking_table(conclusions);
  rates.add_intervals("interval of a mean (Student)", summary, "ci95", 0);
  rates.add_intervals("interval of a mean (BCa)", summary, "bca95", 0);
  rates.add_intervals("interval of a difference", pairs, "ci95", 0);
  rates.add_intervals("interval of the superiority", pairs, "superiority", .5);
  rates.add_tests("paired t-test", pairs, "t_p");
  rates.add_tests("signed-rank test", pairs, "signed_rank_p");
  const std::vector<double> holm = numbers(pairs, "signed_rank_p_holm");
  rates.add("any of a family after Holm", 1 - kConfidence, *std::ranges::min_element(holm) < 1 - kConfidence);
  const std::vector<double> low = numbers(ranking, "rank_low"), high = numbers(ranking, "rank_high");
  bool all = true;
  for (std::size_t m = 0; m < low.size(); ++m) {
    const bool covers = low[m] == 1 && high[m] == static_cast<double>(low.size());
    rates.add("interval of a rank", kConfidence, covers);
    all &= covers;
  }
  rates.add("intervals of all ranks", kConfidence, all);
  for (const ModelPair& pair : model_pairs(DatasetScores(rows, "scans", Observation::shape), 0))
    rates.add("unit shape: interval of a difference", kConfidence,
              pair.by_unit.interval.low <= 0 && 0 <= pair.by_unit.interval.high);
  rates.add_tests("unit shape: rank-sum test", pairs, "rank_sum_p");
}

// Two models that differ by exactly the margin, which half of the tests would find equal if they took no
// care.
void add_equivalence(Rates& rates, const std::vector<ResultRow>& rows, double margin) {
  const DatasetScores scores(rows, "scans", Observation::mesh);
  const Interval interval = compare_models(scores, 0, 0, 1).by_unit.equivalence_interval;
  rates.add("equivalence at its margin", 1 - kConfidence, -margin < interval.low && interval.high < margin);
}

}  // namespace

ScoreModel score_model(const std::vector<ResultRow>& rows, std::string_view dataset, std::size_t metric) {
  const DatasetScores scores(rows, dataset, Observation::shape);
  const UnitScores shapes = scores.compared(metric, scores.competitors(metric));
  const DatasetScores by_mesh(rows, dataset, Observation::mesh);
  const std::vector<std::size_t> mesh_of = by_mesh.units_of_shapes();
  const std::size_t k = shapes.models.size();
  std::map<std::size_t, std::vector<double>> shared;
  std::map<std::pair<std::size_t, std::size_t>, std::vector<double>> own;
  const std::vector<double> means = shapes.scores.means();
  for (std::size_t s = 0; s < shapes.units.size(); ++s) {
    double all = 0;
    for (std::size_t m = 0; m < k; ++m) all += (shapes.scores.at(s, m) - means[m]) / static_cast<double>(k);
    const std::size_t mesh = mesh_of[shapes.units[s]];
    shared[mesh].push_back(all);
    for (std::size_t m = 0; m < k; ++m) own[{m, mesh}].push_back(shapes.scores.at(s, m) - means[m] - all);
  }
  const auto values = [](const auto& groups) {
    std::vector<std::vector<double>> found;
    for (const auto& [key, group] : groups) found.push_back(group);
    return found;
  };
  const Spread of_all = spread(values(shared)), of_models = spread(values(own));
  const double views = static_cast<double>(shapes.units.size()) / static_cast<double>(shared.size());
  const double left = static_cast<double>(k) / static_cast<double>(k - 1);  // what a mean over k takes away
  ScoreModel model;
  model.models = k;
  model.meshes = shared.size();
  model.views = static_cast<std::size_t>(std::lround(views));
  model.view = deviation(of_all.within);
  model.mesh = deviation(of_all.between - of_all.within / views);
  model.model_of_view = deviation(left * of_models.within);
  model.model_of_mesh = deviation(left * (of_models.between - of_models.within / views));
  return model;
}

std::vector<Rate> calibrate(const ScoreModel& model, std::size_t data_sets, std::uint64_t seed) {
  Rates rates;
  SimulatedScores scores(model);
  ScoreModel two = model;
  two.models = 2;
  SimulatedScores pair(two);
  const double margin = 3 * pair.standard_error();
  for (std::size_t i = 0; i < data_sets; ++i) {
    Rng rng(seed, "calibrate", std::to_string(i));
    add_equal_models(rates, scores.draw(rng), seed + i);
    add_equivalence(rates, pair.draw(rng, margin), margin);
  }
  return rates.take();
}

}  // namespace salbench
