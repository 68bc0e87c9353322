// SPDX-License-Identifier: GPL-3.0-or-later
// VIS, visibility: the control that uses only the range of directions from which a point is visible. People
// cannot mark what they never saw.
#pragma once

#include <cstdint>

#include "stages/core/options.h"
#include "stages/core/types.h"
#include "stages/models/about.h"

namespace salbench {

inline constexpr ModelAbout kVisAbout = {
    .name = "Visibility: how much of the half space above a point sees it",
    .values = "; 0 to 1",
};

struct VisOptions {
  std::int32_t directions = 128;
  std::int32_t sample = 65536;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("directions", self.directions,
          {"directions in the half space above a point that it is looked at from", "directions",
           between(1, 4096)});
    visit("sample", self.sample,
          {"a larger shape is looked at in an even sample, and its other points take values in between",
           "points", at_least(1000)});
  }
};

// Fraction in [0, 1] of the directions above a point, evenly distributed over the half space of its normal,
// from which it is not occluded, seen from infinity: 1 everywhere on a convex shape. The occluder is the
// surface or, for points without a surface, a disc around each point, perpendicular to its normal. All points
// use the same directions in the shape's own coordinates, so that the map has no noise but changes slightly
// under rotation; it is invariant to translation and scale. Coordinates are rounded to float. O(n log n).
//
// Throws InputError for a shape without points or extent, for a coordinate that is not finite, or whose
// square overflows, and for a face whose point does not exist.
ScalarField vis_saliency(Points points, const Normals& normals, Surface surface, const VisOptions& options);

}  // namespace salbench
