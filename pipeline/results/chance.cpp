// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/results/chance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "pipeline/results/unit_scores.h"
#include "pipeline/rules/models.h"
#include "stages/core/parallel.h"

namespace salbench {
namespace {

constexpr double kRounding = 1e-12;  // relative difference: the same scores summed in another order

bool is_chance(const std::string& model) { return model == kChance || model == kConstantMap; }

// "PS (by 0.064), HS (level)": the models that the reference is level with or ahead of; empty if there is
// none.
std::string passed_by(const std::string& reference, const DatasetScores& scores, std::size_t metric,
                      bool higher_is_better) {
  const std::vector<std::string>& names = scores.models();
  const std::vector<std::size_t> scored = scores.scored(metric);
  const auto found = std::ranges::find(scored, reference, [&](std::size_t m) { return names[m]; });
  if (found == scored.end()) return {};
  std::string passed;
  for (const std::size_t model : scored) {
    if (is_chance(names[model])) continue;
    const std::array both{*found, model};
    const UnitScores compared = scores.compared(metric, both);
    if (compared.units.empty()) continue;
    const std::vector<double> means = compared.scores.means();
    const double ahead = higher_is_better ? means[0] - means[1] : means[1] - means[0];
    const double level = kRounding * std::max(std::abs(means[0]), std::abs(means[1]));
    if (ahead < -level) continue;
    passed += fmt::format("{}{} ({})", passed.empty() ? "" : ", ", names[model],
                          ahead > level ? fmt::format("by {:.3g}", ahead) : "level");
  }
  return passed;
}

std::string remark_on(const DatasetScores& scores, std::size_t metric, bool higher_is_better) {
  std::string text;
  for (const auto& [reference, words] : {std::pair{kChance, "chance (RS)"}, {kConstantMap, "a constant map"}})
    if (const std::string passed = passed_by(std::string(reference), scores, metric, higher_is_better);
        !passed.empty())
      text += fmt::format("{}{} is level with or ahead of {}", text.empty() ? "" : "; ", words, passed);
  return text;
}

}  // namespace

std::vector<ChanceRemark> chance_remarks(const std::vector<ResultRow>& rows, const Metrics& metrics,
                                         Observation unit) {
  std::vector<ChanceRemark> remarks;
  for (const std::string_view dataset : kShapeNames) {
    const DatasetScores scores(rows, dataset, unit);
    std::vector<std::string> texts(metrics.size());
    parallel_ranges(metrics.size(), 1, [&](std::size_t m, std::size_t) {
      texts[m] = remark_on(scores, m, metrics[m].higher_is_better);
    });
    for (std::size_t m = 0; m < metrics.size(); ++m)
      if (!texts[m].empty()) remarks.push_back({std::string(dataset), metrics[m].name, texts[m]});
  }
  return remarks;
}

}  // namespace salbench
