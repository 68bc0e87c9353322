// SPDX-License-Identifier: GPL-3.0-or-later
// Simplified point feature histograms (SPFH), to which each pair of a point and a neighbour votes. [rusu2009]
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "stages/core/types.h"
#include "stages/descriptors/neighbourhoods.h"
#include "stages/descriptors/pair_features.h"

namespace salbench {

inline constexpr std::size_t kSpfhBins = 3 * kFilledBins;  // theta, alpha, phi; the other bins remain empty

// Divisor of a point's votes; 1 for a point without neighbours.
inline double vote_divisor(std::size_t others) {
  return static_cast<double>(std::max<std::size_t>(others, 1));
}

// Normalised votes of the requested points.
class SimplifiedHistograms {
 public:
  // `swap` as in pair_features().
  SimplifiedHistograms(Points points, std::span<const Vec3> normals,
                       const std::vector<std::int32_t>& requested, const Neighbourhoods& neighbourhoods,
                       bool swap);

  const float* of(std::int32_t point) const { return rows_.data() + row_of(point) * kSpfhBins; }

 private:
  using Votes = std::array<std::uint32_t, kSpfhBins>;

  void vote_by_points(const std::vector<std::int32_t>& requested, const Neighbourhoods& neighbourhoods);
  void vote_by_pairs(const std::vector<std::int32_t>& requested, double radius);
  void vote(std::int32_t i, std::span<const Neighbour> neighbours, bool both);
  void vote_for_few(std::int32_t i, std::span<const std::int32_t> others, bool both, Votes& own);

  std::size_t row_of(std::int32_t point) const { return row_of_[index(point)]; }

  Points points_;
  std::span<const Vec3> normals_;
  std::vector<std::size_t> row_of_;
  std::vector<Votes> votes_;
  std::vector<std::size_t> neighbours_;  // number of other points that voted
  std::vector<float> rows_;              // normalised votes
  bool swap_;
};

}  // namespace salbench
