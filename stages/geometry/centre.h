// SPDX-License-Identifier: GPL-3.0-or-later
// Centre bias of a shape. In pictures people look at the centre; on a shape they mark what is far from it.
#pragma once

#include <array>
#include <cstdint>

#include "stages/core/types.h"

namespace salbench {

// Distance from the centroid (mean of the points), in units of R: n values in [0, 1], invariant to
// translation, rotation and scale. Throws InputError for a shape without points or extent, and for a
// coordinate that is not finite, or whose square overflows. [tatler2007]
ScalarField distances_from_centroid(Points points);

inline constexpr int kCentreBins = 100;

// Human marks by distance from the centroid: bin k covers k to k + 1 hundredths of R, the last one includes
// R. For several shapes, the sum over them.
struct CentreDensity {
  std::array<double, kCentreBins> marked{};  // share of the ground truth in each bin; sums to 1 per shape
  std::array<double, kCentreBins> points{};  // share of the points
  std::int64_t shapes = 0;                   // 0 if its ground truth is uninformative
};

// Ground truth is the saliency of the visible points, or the picks if saliency is unknown. It is
// uninformative if any value is negative or not finite, or if all are zero. Throws InputError like
// distances_from_centroid, and if the ground truth has a different number of points.
CentreDensity centre_density(Points points, const GroundTruth& truth);

void add(CentreDensity& sum, const CentreDensity& shape);

// Mean ground-truth density of the other shapes in a set at the distance of each point, relative to a uniform
// one: n values >= 0, or none if there are no others. `set` is the sum over all shapes, `own` this shape's
// part of it. 0 at distances where no other shape has points.
ScalarField density_of_others(Points points, const CentreDensity& own, const CentreDensity& set);
// The same; empty if the densities were not computed.
inline ScalarField density_if_known(Points points, const CentreDensity* own, const CentreDensity* set) {
  return own != nullptr && set != nullptr ? density_of_others(points, *own, *set) : ScalarField{};
}

}  // namespace salbench
