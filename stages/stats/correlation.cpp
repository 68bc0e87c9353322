// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/stats/correlation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "stages/core/check.h"
#include "stages/core/field.h"
#include "stages/stats/ranks.h"

namespace salbench {
namespace {

struct Pairs {
  std::vector<double> x, y;
};

Pairs defined(std::span<const double> x, std::span<const double> y) {
  CHECK_EQ(x.size(), y.size());
  Pairs pairs;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (std::isnan(x[i]) || std::isnan(y[i])) continue;
    pairs.x.push_back(x[i]);
    pairs.y.push_back(y[i]);
  }
  return pairs;
}

// The correlation is the same of values times a factor.
void centre(std::vector<double>& values) {
  const double scale = scale_against_overflow(values);
  for (double& value : values) value *= scale;
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  for (double& value : values) value -= mean;
}

double correlation(Pairs pairs) {
  // Exactly constant, before rounding of the mean can pretend a variance.
  if (is_constant(pairs.x) || is_constant(pairs.y)) return std::numeric_limits<double>::quiet_NaN();
  centre(pairs.x);
  centre(pairs.y);
  double xx = 0, yy = 0, xy = 0;
  for (std::size_t i = 0; i < pairs.x.size(); ++i) {
    xx += pairs.x[i] * pairs.x[i];
    yy += pairs.y[i] * pairs.y[i];
    xy += pairs.x[i] * pairs.y[i];
  }
  return std::clamp(xy / (std::sqrt(xx) * std::sqrt(yy)), -1.0, 1.0);
}

}  // namespace

double pearson(std::span<const double> x, std::span<const double> y) { return correlation(defined(x, y)); }

double spearman(std::span<const double> x, std::span<const double> y) {
  const Pairs pairs = defined(x, y);
  return correlation({midranks(pairs.x).rank, midranks(pairs.y).rank});
}

}  // namespace salbench
