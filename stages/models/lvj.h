// SPDX-License-Identifier: GPL-3.0-or-later
// LVJ, mesh saliency by Lee, Varshney and Jacobs: difference of the mean curvature around a point from that
// in a wider surrounding, at five scales.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "stages/core/options.h"
#include "stages/core/types.h"
#include "stages/geometry/mesh_ops.h"
#include "stages/models/about.h"
#include "stages/models/curvature.h"

namespace salbench {

inline constexpr ModelAbout kLvjAbout = {
    .name = "Mesh saliency",
    .authors = "Lee, Varshney, Jacobs",
    .year = "2005",
    .link = "https://doi.org/10.1145/1073204.1073244",
    .key = "lee2005",
    .values = ": mean curvature against that of a wider surrounding; >= 0",
};

struct LvjOptions {
  double epsilon = 0.003;
  CurvatureMethod curvature = CurvatureMethod::taubin;
  std::int32_t faces = 60000;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("epsilon", self.epsilon,
          {"unit of the scales, which are 2 to 6 of it", "diagonal of the bounding box",
           above_and_up_to(0, 1)});
    visit("curvature", self.curvature, {"how the mean curvature of the surface is computed"});
    visit("faces", self.faces, {"larger surfaces are simplified to so many faces", "faces", at_least(1000)});
  }
};

inline constexpr std::array<int, 5> kLvjScales = {2, 3, 4, 5, 6};  // standard deviations of G, in epsilon

// [scale][point]: |G(sigma) - G(2 sigma)|, with G the Gaussian mean of the values over the points within two
// standard deviations. Points are weighted equally, as published. [lee2005]
std::array<ScalarField, kLvjScales.size()> centre_surround(std::span<const Vec3> points,
                                                           const ScalarField& values, double epsilon);

// Weight of a scale in the sum: (1 - m)^2, with m the mean over the local maxima of the min-max-normalised
// map, excluding its largest value. A single peak gives 1, many equal ones 0. A local maximum is higher than
// some of its neighbours and lower than none. [itti1998] [lee2005]
double suppression(std::span<const double> normalised, const Adjacency& adjacency);

// Sum over the scales of the normalised and suppressed maps, >= 0. Invariant to translation and scale of the
// shape; depends on its orientation through the bounding box. A scale without contrast adds 0, so that all
// values are 0 for a shape of constant curvature or without faces. Above `faces`, time is that of the
// simplification. Throws InputError for a shape without points or extent, for a coordinate that is not
// finite, or whose square overflows, for a face whose point does not exist, and like require_few_neighbours
// for the widest Gaussian. [lee2005]
ScalarField lvj_saliency(Points points, Surface surface, const LvjOptions& options);

}  // namespace salbench
