// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/core/seen.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "stages/core/check.h"
#include "stages/core/field.h"

namespace salbench {

std::optional<std::vector<std::int32_t>> seen_points(std::span<const double> saliency) {
  if (std::ranges::none_of(saliency, [](double value) { return std::isnan(value); })) return {};
  std::vector<std::int32_t> points;
  for (std::size_t i = 0; i < saliency.size(); ++i)
    if (!std::isnan(saliency[i])) points.push_back(static_cast<std::int32_t>(i));
  return points;
}

GroundTruth truth_at(const GroundTruth& truth, std::span<const std::int32_t> points) {
  GroundTruth result;
  result.simulated = truth.simulated;
  if (!truth.saliency.empty()) result.saliency = values_at(truth.saliency, points);
  for (const auto& participant : truth.picks) {
    std::vector<std::int32_t>& kept = result.picks.emplace_back();
    for (const std::int32_t pick : participant) {
      const auto place = std::ranges::lower_bound(points, pick);
      if (place != points.end() && *place == pick)
        kept.push_back(static_cast<std::int32_t>(place - points.begin()));
    }
  }
  return result;
}

ScalarField mean_of_seen(std::span<const ScalarField> maps, std::span<const std::size_t> members) {
  CHECK_GT(members.size(), 0U);
  std::vector<std::size_t> in_order(members.begin(), members.end());
  std::ranges::sort(in_order);
  ScalarField mean(maps[in_order[0]].size());
  for (std::size_t i = 0; i < mean.size(); ++i) {
    double sum = 0, count = 0;
    for (const std::size_t k : in_order) {
      if (std::isnan(maps[k][i])) continue;
      sum += maps[k][i];
      ++count;
    }
    mean[i] = count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
  }
  return mean;
}

}  // namespace salbench
