// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/chi2_sums.h"

#include <array>
#include <cmath>
#include <cstdint>

#include "stages/core/check.h"
#include "stages/core/parallel.h"

namespace salbench {
namespace {

using chi2_kernel::groups_of;
using chi2_kernel::kLanes;

constexpr std::size_t kGrain = 1024;  // queries one after the other; the first of them guesses nothing

using Position = std::array<float, 3>;

Position position(const Vec3& point) {
  return {static_cast<float>(point.x()), static_cast<float>(point.y()), static_cast<float>(point.z())};
}

// The smallest for which a sum over all of the table is exact: no weight is above 2.
float grid_for(const Chi2Search& search) {
  const double largest_sum =
      2 * static_cast<double>(search.beyond_all()) * static_cast<double>(search.size());
  return largest_sum > 0 ? static_cast<float>(std::exp2(std::ceil(std::log2(largest_sum)) - 30)) : 1;
}

// Terms of a sum: one per reference, its distance weighted by how far it lies away in space.
class Terms {
 public:
  Terms(const Chi2Search& search, Points points, chi2_kernel::Weight weight)
      : points_(points),
        weight_(weight),
        grid_(grid_for(search)),
        places_(groups_of(search.size()) * 3 * kLanes) {
    const std::vector<std::int32_t>& order = search.table().order;
    for (std::size_t place = 0; place < order.size(); ++place) {
      const Position at = position(points[static_cast<std::size_t>(order[place])]);
      for (std::size_t axis = 0; axis < 3; ++axis)
        places_[(place / kLanes * 3 + axis) * kLanes + place % kLanes] = at[axis];
    }
  }

  // Over the nearest of the i-th histogram.
  double sum(std::size_t i, const Chi2Nearest& nearest) const {
    const Position from = position(points_[i]);
    double sum = nearest.look().sum_up_to(nearest.sure(), weight_, grid_, places_.data(), from.data());
    for (const auto& [index, chi2] : nearest.others()) {
      const Position at = position(points_[static_cast<std::size_t>(index)]);
      const float dx = at[0] - from[0], dy = at[1] - from[1], dz = at[2] - from[2];
      const float distance = std::sqrt(dx * dx + dy * dy + dz * dz);
      sum += static_cast<double>(chi2_kernel::term_of(weight_, grid_, chi2, distance));
    }
    return sum;
  }

 private:
  Points points_;
  chi2_kernel::Weight weight_;
  float grid_;
  std::vector<float> places_;  // groups x 3 x 16
};

}  // namespace

std::vector<double> weighted_sums(const Chi2Search& search, std::size_t k, Points points,
                                  chi2_kernel::Weight weight, std::vector<float>& kth) {
  const std::size_t n = search.queries().size();
  CHECK_EQ(points.size(), n);
  kth.resize(n);
  const Terms terms(search, points, weight);
  std::vector<double> sums(n);
  parallel_ranges(n, kGrain, [&](std::size_t first, std::size_t last) {
    Chi2Nearest nearest = search.nearest(k);
    for (std::size_t q = first; q < last; ++q) {
      const auto i = static_cast<std::size_t>(search.queries()[q]);
      nearest.start(search.row(q));
      if (!nearest.find_unless_alike(kth[i])) continue;
      kth[i] = nearest.kth();
      sums[i] = terms.sum(i, nearest);
    }
  });
  return sums;
}

}  // namespace salbench
