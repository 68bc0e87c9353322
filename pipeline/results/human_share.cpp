// SPDX-License-Identifier: GPL-3.0-or-later

#include <algorithm>
#include <cmath>
#include <string_view>

#include "pipeline/results/table_rows.h"
#include "pipeline/rules/models.h"
#include "stages/stats/human_scale.h"
#include "stages/stats/paired.h"

namespace salbench {
namespace {

constexpr std::string_view kPeople = "HS";  // with kChance, the ends of the scale

// The models, chance and people under one metric, on the same units.
struct Scale {
  UnitScores scores = {};  // columns: competitors, chance, people
  std::vector<double> means = {};
  std::vector<Share> shares = {};  // [competitor]; empty if `remark` says why
  std::string remark = {};
};

bool is_clearly_better(const Columns& scores, std::size_t a, std::size_t b, bool higher_is_better) {
  const PairedComparison found = compare_paired(scores.column(a), scores.column(b));
  return found.t_p < kLevel && (higher_is_better ? found.mean_difference > 0 : found.mean_difference < 0);
}

Scale scale_of(const DatasetScores& scores, const RankedMetric& ranked, bool higher_is_better,
               const Bootstrap& bootstrap) {
  const std::vector<std::size_t> scored = scores.scored(ranked.metric);
  std::vector<std::size_t> columns = ranked.scores.models;
  for (const std::string_view name : {kChance, kPeople}) {
    const auto found =
        std::ranges::find_if(scored, [&](std::size_t model) { return scores.models()[model] == name; });
    if (found == scored.end()) return {.remark = "no scores of " + std::string(name)};
    columns.push_back(*found);
  }
  Scale scale{.scores = scores.compared(ranked.metric, columns)};
  const Columns& compared = scale.scores.scores;
  const std::size_t n_models = columns.size() - 2;
  if (scale.scores.units.empty()) return {.remark = "no shape has scores of HS, RS and all models"};
  scale.means = compared.means();
  if (scale.scores.units.size() < 2)
    scale.remark = "one unit: it does not show that HS is better than RS";
  else if (!is_clearly_better(compared, n_models + 1, n_models, higher_is_better))
    scale.remark = "HS is not clearly better than RS";
  else
    scale.shares = shares_of_people(compared, bootstrap.means(compared));
  return scale;
}

std::string remark_on(const Interval& interval, std::size_t units) {
  if (units < kMinUnitsOfPercentiles)
    return "no interval: fewer than " + std::to_string(kMinUnitsOfPercentiles) + " units";
  if (std::isnan(interval.low)) return "no interval: the shares do not vary";
  const bool ends = std::isfinite(interval.low) && std::isfinite(interval.high);
  return ends ? "" : "no interval: HS is too near RS in the resamples";
}

std::vector<Cell> row_of(const DatasetScores& scores, const std::string& metric, const Scale& scale,
                         std::size_t model, std::size_t place) {
  constexpr double kNotScored = std::numeric_limits<double>::quiet_NaN();
  const bool scored = place < scale.means.size();
  const Share share = scored && !scale.shares.empty() ? scale.shares[place] : Share{};
  std::string remark = scale.remark;
  if (remark.empty()) remark = scored ? remark_on(share.interval, scale.scores.units.size()) : "no scores";
  return cells(scores.label(), metric, scores.models()[model], scored ? scale.scores.units.size() : 0,
               scored ? scale.scores.n_shapes : 0, scored ? scale.means[place] : kNotScored,
               scored ? scale.means.end()[-2] : kNotScored, scored ? scale.means.back() : kNotScored,
               share.value, remark.empty() ? share.interval : Interval{}, remark);
}

}  // namespace

Table human_share_table(const Conclusions& conclusions) {
  const auto rows_of = [&](const DatasetScores& scores, const RankedMetric& ranked, const Metric& metric) {
    const Scale scale = scale_of(scores, ranked, metric.higher_is_better, *conclusions.bootstrap);
    Rows rows;
    for (std::size_t model = 0; model < scores.models().size(); ++model)
      if (!scores.is_reference(model)) {
        const std::size_t place = ranked.scores.column_of(model);
        rows.push_back(row_of(scores, metric.name, scale, model,
                              place < ranked.scores.models.size() ? place : scale.means.size()));
      }
    return rows;
  };
  return {.columns = conclusions.labelled({"dataset", "metric", "model", "n", "n_shapes", "mean", "mean_rs",
                                           "mean_hs", "share", "ci95_low", "ci95_high", "remark"}),
          .rows = rows_by_metric(conclusions, rows_of)};
}

}  // namespace salbench
