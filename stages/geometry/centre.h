// SPDX-License-Identifier: GPL-3.0-or-later
// Centre bias of a shape. In pictures people look at the centre; of a shape they mark what is far from it.
#pragma once

#include <array>
#include <cstdint>

#include "stages/core/types.h"

namespace salbench {

// Distance from the centroid, the mean of the points, in R: n values in [0, 1]. Does not depend on place,
// orientation and size of the shape. Throws InputError for a shape without points or extent, and for a
// coordinate that is not finite, or whose square overflows. [tatler2007]
ScalarField distances_from_centroid(Points points);

inline constexpr int kCentreBins = 100;

// Where people mark shapes, by the distance from the centroid: bin k holds distances of k to k + 1 hundredths
// of R, the last one R as well. Of several shapes, the sums of theirs.
struct CentreDensity {
  std::array<double, kCentreBins> marked{};  // share of the ground truth in each bin; sums to 1 per shape
  std::array<double, kCentreBins> points{};  // share of the points
  std::int64_t shapes = 0;                   // 0 for one whose ground truth says nothing
};

// The ground truth is the saliency of the points that were seen, or the picks where no saliency is known. One
// that is negative somewhere, not finite or zero everywhere says nothing. Throws InputError as
// distances_from_centroid does, and where the ground truth has another number of points.
CentreDensity centre_density(Points points, const GroundTruth& truth);

void add(CentreDensity& sum, const CentreDensity& shape);

// Mean density of the ground truth of the other shapes of a set at the distance of each point, as a multiple
// of a uniform one: n values >= 0, or none if there are no others. `set` is the sum over all shapes; `own` is
// what this shape added to it. 0 at distances that no other shape has.
ScalarField density_of_others(Points points, const CentreDensity& own, const CentreDensity& set);
// The same; none where nobody asked for the densities.
inline ScalarField density_if_known(Points points, const CentreDensity* own, const CentreDensity* set) {
  return own != nullptr && set != nullptr ? density_of_others(points, *own, *set) : ScalarField{};
}

}  // namespace salbench
