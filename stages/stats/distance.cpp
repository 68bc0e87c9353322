// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/stats/distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace salbench {

double kolmogorov_smirnov(const Histogram& a, const Histogram& b) {
  const double total_a = std::accumulate(a.begin(), a.end(), 0.0);
  const double total_b = std::accumulate(b.begin(), b.end(), 0.0);
  if (!(total_a > 0 && total_b > 0)) return std::numeric_limits<double>::quiet_NaN();
  double below_a = 0, below_b = 0, largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    below_a += a[i];
    below_b += b[i];
    largest = std::max(largest, std::abs(below_a / total_a - below_b / total_b));
  }
  return largest;
}

}  // namespace salbench
