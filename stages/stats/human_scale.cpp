// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/stats/human_scale.h"

#include <cmath>

#include "stages/core/check.h"

namespace salbench {
namespace {

std::span<const double> row_of(const Columns& columns, std::size_t row) {
  return std::span(columns.values).subspan(row * columns.count, columns.count);
}

// Means of one model, of chance and of people as a share. Where people are no better than chance, however the
// sample is drawn, every share is as likely: the sign of what the model is ahead of chance decides.
double share_of(double model, double chance, double people, double sign) {
  const double span = sign * (people - chance), ahead = sign * (model - chance);
  if (span > 0) return ahead / span;
  return ahead == 0 ? 0 : std::copysign(std::numeric_limits<double>::infinity(), ahead);
}

}  // namespace

double first_reached(std::span<const double> curve, double level, bool higher_is_better) {
  CHECK_LT(0U, curve.size());
  const auto ahead = [&](std::size_t i) { return higher_is_better ? curve[i] - level : level - curve[i]; };
  if (ahead(0) > 0) return -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < curve.size(); ++i) {
    if (ahead(i) < 0) continue;
    const auto n = static_cast<double>(i + 1);
    return i == 0 ? n : n - ahead(i) / (ahead(i) - ahead(i - 1));
  }
  return std::numeric_limits<double>::infinity();
}

int crossings(std::span<const double> curve, double level) {
  int count = 0;
  double side = 0;
  for (const double value : curve) {
    if (value == level) continue;
    if (side * (value - level) < 0) ++count;
    side = value > level ? 1 : -1;
  }
  return count;
}

std::vector<Equivalent> equivalents(const Columns& scores, const Columns& resampled, std::size_t length,
                                    bool higher_is_better) {
  CHECK_LE(length, scores.count);
  const std::vector<double> means = scores.means();
  const std::span<const double> curve = std::span(means).first(length);
  std::vector<Equivalent> found;
  for (std::size_t model = length; model < scores.count; ++model) {
    std::vector<double> positions(resampled.units());
    for (std::size_t r = 0; r < positions.size(); ++r) {
      const std::span<const double> row = row_of(resampled, r);
      positions[r] = first_reached(row.first(length), row[model], higher_is_better);
    }
    found.push_back({first_reached(curve, means[model], higher_is_better),
                     percentile_interval(std::move(positions), scores.units()),
                     crossings(curve, means[model])});
  }
  return found;
}

std::vector<Share> shares_of_people(const Columns& scores, const Columns& resampled) {
  CHECK_LE(2U, scores.count);
  const std::size_t chance = scores.count - 2, people = scores.count - 1;
  const std::vector<double> means = scores.means();
  const double sign = means[people] > means[chance] ? 1 : -1;
  std::vector<Share> found;
  for (std::size_t model = 0; model < chance; ++model) {
    std::vector<double> shares(resampled.units());
    for (std::size_t r = 0; r < shares.size(); ++r)
      shares[r] = share_of(resampled.at(r, model), resampled.at(r, chance), resampled.at(r, people), sign);
    found.push_back({share_of(means[model], means[chance], means[people], sign),
                     percentile_interval(std::move(shares), scores.units())});
  }
  return found;
}

}  // namespace salbench
