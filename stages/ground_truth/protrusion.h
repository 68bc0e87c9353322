// SPDX-License-Identifier: GPL-3.0-or-later
// The bulges of a surface at a given scale.
#pragma once

#include "stages/core/types.h"

namespace salbench {

// The signed distance of each vertex from a smoothed copy of the surface, along its normal, in units of scale
// * sqrt(surface area); positive outside, on a mesh that is oriented outwards. The copy has diffused as far
// as a Gaussian of standard deviation sqrt(2) times that unit, whatever the density of vertices, so the
// result estimates 2 * mean curvature * unit. It is 0 at vertices without faces, and everywhere if the
// surface has no area.
ScalarField protrusion(const Mesh& mesh, double scale);

}  // namespace salbench
