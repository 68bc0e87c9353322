// SPDX-License-Identifier: GPL-3.0-or-later
// Mean curvature of a surface, for models based on it.
#pragma once

#include <array>
#include <string_view>

#include "stages/core/options.h"
#include "stages/core/types.h"

namespace salbench {

enum class CurvatureMethod {
  cotangent,  // cotangent Laplacian of the positions over the mixed Voronoi area [meyer2003]
  taubin      // mean normal curvature of the edges, weighted by the area of their faces [taubin1995]
};
template <>
struct EnumNames<CurvatureMethod> {
  static constexpr std::array<std::string_view, 2> names{"cotangent", "taubin"};
};

// H = (k1 + k2) / 2 per point, in 1 / length, positive where the surface is convex as seen from the side on
// which its faces are counter-clockwise. Faces without area are ignored.
//
// A point has its own curvature if it is at a face with an area and, for `cotangent`, only at edges of
// exactly two such faces: at a boundary, the Laplacian depends on where the surface ends. Every other point
// takes the value of the nearest point that has one; all are 0 if there is none. O(n log n). Throws
// InputError for a face whose point does not exist; coordinates must be finite, and their squares must not
// overflow.
ScalarField mean_curvature(Points points, Surface surface, CurvatureMethod method);

}  // namespace salbench
