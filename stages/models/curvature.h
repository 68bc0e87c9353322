// SPDX-License-Identifier: GPL-3.0-or-later
// Mean curvature of a surface, for the models that begin with it.
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

// H = (k1 + k2) / 2 per point, in 1 / length, positive where the surface is convex seen from the side that
// its faces are counter-clockwise from. A face without area counts as none.
//
// A point has a curvature of its own if it is at a face with an area and, for `cotangent`, at no edge that
// has other than two such faces: at the end of a surface its Laplacian says where the surface ends. Every
// other point takes the value of the nearest one that has; all are 0 if none has. O(n log n). Throws
// InputError for a face whose point does not exist; coordinates are finite, and their squares do not
// overflow.
ScalarField mean_curvature(Points points, Surface surface, CurvatureMethod method);

}  // namespace salbench
