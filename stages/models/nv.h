// SPDX-License-Identifier: GPL-3.0-or-later
// NV, normal variation: the floor that knows normals alone. What is not flat is salient.
#pragma once

#include "stages/core/options.h"
#include "stages/core/types.h"

namespace salbench {

struct NvOptions {
  double radius = 0.02;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("radius", self.radius,
          {"how far neighbours are, enlarged until it holds 6 other points on average", "R", above(0)});
  }
};

// One minus the mean dot product of a point's normal with those of its neighbours: 0 on a plane, at most 2.
// Half the mean squared difference of the normals is the same, and what is computed, since it is exactly 0
// where they are equal. No direction is chosen, as covariances would, and of no normal but the point's own is
// more asked than its likeness. A point without neighbours has 0.
//
// Does not depend on place, orientation and size. O(n log n) while neighbours are few. Throws InputError for
// a shape without points or extent, for a coordinate that is not finite, or whose square overflows, and as
// grown_support_radius does.
ScalarField nv_saliency(Points points, const Normals& normals, const NvOptions& options);

}  // namespace salbench
