// SPDX-License-Identifier: GPL-3.0-or-later
// LCE, local curvature entropy: information content of the curvature around a point, at five scales.
#pragma once

#include <cstdint>
#include <span>

#include "stages/core/options.h"
#include "stages/core/types.h"
#include "stages/models/about.h"
#include "stages/models/curvature.h"

namespace salbench {

inline constexpr ModelAbout kLceAbout = {
    .name = "Local curvature entropy",
    .authors = "Limper, Kuijper, Fellner",
    .year = "2016",
    .link = "https://doi.org/10.2312/egsh.20161003",
    .key = "limper2016",
    .values = ", in bits",
};

struct LceOptions {
  CurvatureMethod curvature = CurvatureMethod::cotangent;
  std::int32_t bins = 256;
  double radius = 0.08;
  std::int32_t levels = 5;
  std::int32_t faces = 60000;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("curvature", self.curvature, {"how the mean curvature of the surface is computed"});
    visit("bins", self.bins, {"bins of curvature, equally wide", "bins", between(2, 4096)});
    visit("radius", self.radius,
          {"reach of the widest neighbourhood; each level has half of the one before", "sqrt(surface area)",
           above_and_up_to(0, 1)});
    visit("levels", self.levels,
          {"neighbourhoods that the entropy is averaged over", "levels", between(1, 16)});
    visit("faces", self.faces, {"larger surfaces are simplified to so many faces", "faces", at_least(1000)});
  }
};

// Mean over the levels of the Shannon entropy, in bits, of the curvature around each point: -sum p log2 p,
// with p the part of the area within reach whose curvature is in a bin. Reach is measured along edges, and
// radii are largest first, each at most the one before. n; 0 where all area is in one bin. `areas` are those
// of the vertices. [limper2016]
ScalarField local_entropy(const Mesh& mesh, std::span<const std::int32_t> bin, std::span<const double> areas,
                          std::span<const double> radii);

// In [0, log2 bins], from signed mean curvature. Invariant to translation, rotation and scale of the shape. A
// point without faces takes the value of the nearest one that has any; all values are 0 for a shape without
// faces or of constant curvature. Above `faces`, time is that of the simplification. Throws InputError for a
// shape without points or extent, for a coordinate that is not finite, or whose square overflows, for a face
// whose point does not exist, and like require_few_neighbours for the widest neighbourhood. [limper2016]
ScalarField lce_saliency(Points points, Surface surface, const LceOptions& options);

}  // namespace salbench
