// SPDX-License-Identifier: GPL-3.0-or-later
// MC, mean-curvature magnitude: the baseline of every paper on mesh saliency. What bends is salient.
#pragma once

#include "stages/core/options.h"
#include "stages/core/types.h"
#include "stages/models/curvature.h"

namespace salbench {

struct McOptions {
  CurvatureMethod curvature = CurvatureMethod::cotangent;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("curvature", self.curvature, {"how the mean curvature of the surface is computed"});
  }
};

// |H| in 1 / R, >= 0; see mean_curvature() for boundaries, isolated points and edges of more than two faces.
// Does not depend on place, orientation and size of the shape, nor, as a magnitude, on which way its faces
// are turned. O(n log n). All values are 0 for a shape without faces. Throws InputError for a shape without
// points or extent, for a coordinate that is not finite, or whose square overflows, and for a face whose
// point does not exist. [meyer2003]
ScalarField mc_saliency(Points points, Surface surface, const McOptions& options);

}  // namespace salbench
