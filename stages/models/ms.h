// SPDX-License-Identifier: GPL-3.0-or-later
// MS, mesh saliency by spectral processing: irregularities of the log-Laplacian spectrum, transformed back to
// the surface.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "stages/core/options.h"
#include "stages/core/types.h"
#include "stages/models/about.h"

namespace salbench {

inline constexpr ModelAbout kMsAbout = {
    .name = "Mesh saliency by spectral processing",
    .authors = "Song, Liu, Martin, Rosin",
    .year = "2014",
    .link = "https://doi.org/10.1145/2530691",
    .key = "song2014",
    .values = ": irregularities of the log-Laplacian spectrum; logarithms",
    .by_default = true,
};

enum class MsScales {
  single,  // the shape as it is
  paper    // changes between the shape smoothed by five Gaussians, t_k = k epsilon^2
};
template <>
struct EnumNames<MsScales> {
  static constexpr std::array<std::string_view, 2> names{"single", "paper"};
};

enum class MsWeight {
  area,            // sums over neighbours are divided by the area of the vertex
  inverse_square,  // neighbours are weighted by 1 / distance^2 [song2014]
};
template <>
struct EnumNames<MsWeight> {
  static constexpr std::array<std::string_view, 2> names{"area", "inverse_square"};
};

inline constexpr std::size_t kMsSmallestComponent = 20;  // vertices

struct MsOptions {
  std::int32_t faces = 3000;
  std::int32_t window = 9;
  std::int32_t frequencies = 6;
  std::int32_t eigenpairs = 14;
  MsWeight weight = MsWeight::area;
  MsScales scales = MsScales::single;
  double epsilon = 0.004;

  static MsOptions text();  // as the paper's text: five scales, neighbours weighted by 1 / distance^2

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("faces", self.faces, {"larger meshes are simplified to so many faces", "faces", at_least(100)});
    visit("window", self.window,
          {"width of the average over the log spectrum, odd (n in the paper)", "frequencies", at_least(1)});
    visit("frequencies", self.frequencies,
          {"lowest frequencies whose irregularity counts", "frequencies", at_least(1)});
    visit("eigenpairs", self.eigenpairs,
          {"lowest eigenpairs that are computed, at least frequencies + window / 2", "eigenpairs",
           between(1, kMsSmallestComponent - 2)});
    visit("weight", self.weight, {"what a neighbour counts"});
    visit("scales", self.scales, {"shape as it is, or the changes over the paper's five smoothings"});
    visit("epsilon", self.epsilon, {"smallest smoothing, as a standard deviation", "R", above(0)});
  }
};
void check(const MsOptions& options);  // throws OptionError

// Uses the largest connected component of the surface; every other point takes the value of its nearest
// vertex. The values are logarithms, of any sign. All points are 0 if the model gives no result:
// - all points coincide;
// - the component, simplified, has fewer than 20 vertices, for example without faces;
// - the faces of the component have no area, which MsWeight::area divides by;
// - an eigensolver fails, for example if all vertices of the component coincide;
// - no value is positive before the logarithm, for example if no smoothing of MsScales::paper moves a vertex.
// Throws InputError for a face whose point does not exist, for coordinates that are not finite or whose
// squares overflow, and like require_few_neighbours for the widest Gaussian. [song2014] [tasse2016]
ScalarField ms_saliency(Points points, Surface surface, const MsOptions& options);

}  // namespace salbench
