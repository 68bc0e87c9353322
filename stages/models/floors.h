// SPDX-License-Identifier: GPL-3.0-or-later
// Trivial and simple baselines: models that use a single cue each, which others have to beat.
#pragma once

#include "stages/core/options.h"
#include "stages/core/rng.h"
#include "stages/core/types.h"
#include "stages/models/about.h"
#include "stages/models/curvature.h"

namespace salbench {

// RS, random saliency: the baseline of chance agreement.
inline constexpr ModelAbout kRsAbout = {
    .name = "Chance: a random number per point",
    .key = "tasse2016",
    .values = ", uniform in [0, 1)",
    .by_default = true,
    .is_reference = true,
    .is_floor = true,
};
using RsOptions = NoOptions;

// Uniform in [0, 1); depends only on the random source and the number of points. [tasse2016]
ScalarField rs_saliency(Points points, const RandomSource& random, const RsOptions& options);

// CB, centre bias: the control that uses only a point's position.
inline constexpr ModelAbout kCbAbout = {
    .name = "Centre bias: the distance from the centroid",
    .authors = "after Tatler",
    .year = "2007",
    .link = "https://doi.org/10.1167/7.14.4",
    .key = "tatler2007",
    .values = ", in R",
    .is_floor = true,
};
using CbOptions = NoOptions;

// distances_from_centroid() of stages/geometry/centre.h.
ScalarField cb_saliency(Points points, const CbOptions& options);

// NV, normal variation: the trivial baseline that uses only normals. Whatever is not flat is salient.
inline constexpr ModelAbout kNvAbout = {
    .name = "Variation of the normals around a point",
    .values = ": one minus the mean dot product of its normal with theirs; 0 to 2",
    .is_floor = true,
};
struct NvOptions {
  double radius = 0.02;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("radius", self.radius,
          {"how far neighbours are, enlarged until it holds 6 other points on average", "R", above(0)});
  }
};

// One minus the mean dot product of a point's normal with those of its neighbours: 0 on a plane, at most 2.
// Computed as half the mean squared difference of the normals, which is equal, and exactly 0 for equal
// normals. Unlike a covariance, it has no preferred direction, and it compares each normal only with the
// point's own. A point without neighbours has 0.
//
// Invariant to translation, rotation and scale. O(n log n) while neighbours are few. Throws InputError for a
// shape without points or extent, for a coordinate that is not finite, or whose square overflows, and like
// grown_support_radius.
ScalarField nv_saliency(Points points, const Normals& normals, const NvOptions& options);

// MC, mean-curvature magnitude: the baseline of every paper on mesh saliency. Whatever is curved is salient.
inline constexpr ModelAbout kMcAbout = {
    .name = "Magnitude of the mean curvature",
    .authors = "Meyer, Desbrun, Schröder, Barr",
    .year = "2003",
    .link = "https://doi.org/10.1007/978-3-662-05105-4_2",
    .key = "meyer2003",
    .values = ", in 1 / R",
    .is_floor = true,
};
struct McOptions {
  CurvatureMethod curvature = CurvatureMethod::cotangent;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("curvature", self.curvature, {"how the mean curvature of the surface is computed"});
  }
};

// |H| in 1 / R, >= 0; see mean_curvature() for boundaries, isolated points and edges of more than two faces.
// Invariant to translation, rotation and scale of the shape and, as a magnitude, to the orientation of its
// faces. O(n log n). All values are 0 for a shape without faces. Throws InputError for a shape without points
// or extent, for a coordinate that is not finite, or whose square overflows, and for a face whose point does
// not exist. [meyer2003]
ScalarField mc_saliency(Points points, Surface surface, const McOptions& options);

// VD, vertex degree: the trivial baseline that uses only the meshing, not the shape. Its score shows how much
// a learnt model could gain from the edges placed by authors or by meshing software.
inline constexpr ModelAbout kVdAbout = {
    .name = "Number of edges at a vertex",
    .values = "; it knows the meshing alone",
    .is_floor = true,
};
using VdOptions = NoOptions;

// Number of edges at a point; 0 without faces. For points without a mesh, edges of their partial mesh.
// Independent of coordinates. O(n). Throws InputError for a face whose point does not exist.
ScalarField vd_saliency(Points points, Surface surface, const VdOptions& options);

// SD, sampling density: the trivial baseline that uses only the density of points. People and meshing
// software place more points where there is more to see.
inline constexpr ModelAbout kSdAbout = {
    .name = "Sampling density: how closely points lie",
    .values =
        ", in points per R²: one over the area of a vertex, or of the disc that holds the nearest points "
        "where there are no faces; it knows the sampling alone",
    .is_floor = true,
};
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

// For a mesh: one over the area of a vertex, a third of the faces around it; 0 if there are none. O(n).
// Throws InputError for a face whose point does not exist.
ScalarField sd_saliency(Points points, Surface surface, const SdOptions& options);

// For points without a mesh: the number of neighbours over the area of the disc that contains them. If they
// all coincide, the density of the densest other point. O(n log n).
ScalarField sd_saliency_of_points(Points points, const SdOptions& options);

}  // namespace salbench
