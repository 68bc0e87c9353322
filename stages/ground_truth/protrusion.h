// Where a surface bulges, at a given scale.
#pragma once

#include "stages/core/types.h"

namespace salbench {

// How far each vertex lies outside (positive, on a mesh that is oriented outwards) or inside of a smoothed
// copy of the surface, along its normal, in units of scale * sqrt(surface area). The copy has diffused as far
// as a Gaussian of standard deviation sqrt(2) times that unit, whatever the density of vertices: the result
// estimates 2 * mean curvature * unit. 0 at vertices without faces and where the surface has no area.
ScalarField protrusion(const Mesh& mesh, double scale);

}  // namespace salbench
