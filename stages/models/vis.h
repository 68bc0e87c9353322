// SPDX-License-Identifier: GPL-3.0-or-later
// VIS, visibility: the control that knows from how many sides a point can be seen. What people never saw they
// cannot have marked.
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

// Fraction in [0, 1] of the directions above a point, evenly spread over the half space of its normal, from
// which nothing hides it, seen from infinity: 1 everywhere on a convex shape. What hides is the surface; of
// points without a surface, a disc around each, at right angles to its normal. The directions are the same
// in the shape's own coordinates for all points, so that the map has no noise but changes a little when the
// shape is turned; it does not depend on place and size. Coordinates are rounded to float. O(n log n) time.
//
// Throws InputError for a shape without points or extent, for a coordinate that is not finite, or whose
// square overflows, and for a face whose point does not exist.
ScalarField vis_saliency(Points points, const Normals& normals, Surface surface, const VisOptions& options);

}  // namespace salbench
