// SPDX-License-Identifier: GPL-3.0-or-later
// SD, sampling density: the floor that knows alone how closely points lie. Who samples a shape, or a program
// that makes its mesh anew, puts more points where there is more to see.
#pragma once

#include "stages/core/options.h"
#include "stages/core/types.h"

namespace salbench {

struct SdOptions {
  std::int32_t neighbours = 16;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("neighbours", self.neighbours,
          {"on points without a mesh: others in the disc around each", "points", at_least(1)});
  }
};

// Points per R^2. Both throw InputError for a shape without points or extent, for a coordinate that is not
// finite, or whose square overflows.

// Of a mesh: one over the area of a vertex, a third of the faces around it; 0 where there is none. O(n).
// Throws InputError for a face whose point does not exist.
ScalarField sd_saliency(Points points, Surface surface, const SdOptions& options);

// Of points without a mesh: as many neighbours over the area of the disc that holds the nearest ones. Where
// they are all in one place, as dense as the densest other point. O(n log n).
ScalarField sd_saliency_of_points(Points points, const SdOptions& options);

}  // namespace salbench
