// SPDX-License-Identifier: GPL-3.0-or-later
// GC, magnitude of the Gaussian curvature: the floor that knows where a surface is no cylinder.
#pragma once

#include "stages/core/options.h"
#include "stages/core/types.h"
#include "stages/models/about.h"

namespace salbench {

inline constexpr ModelAbout kGcAbout = {
    .name = "Magnitude of the Gaussian curvature",
    .authors = "Meyer, Desbrun, Schröder, Barr",
    .year = "2003",
    .link = "https://doi.org/10.1007/978-3-662-05105-4_2",
    .key = "meyer2003",
    .values = ": how far the angles around a point are from a full turn; >= 0, in radians",
    .is_floor = true,
};
using GcOptions = NoOptions;

// |2 pi - sum of the angles of the faces at a point|: the total curvature around it. 0 at a point without
// faces, and at one on an edge that has other than two faces: at the end of a surface the angles say where
// the surface ends. Does not depend on place, orientation and size of the shape. O(n log n). Throws
// InputError for a shape without points or extent, for a coordinate that is not finite, or whose square
// overflows, and for a face whose point does not exist. [meyer2003]
ScalarField gc_saliency(Points points, Surface surface, const GcOptions& options);

}  // namespace salbench
