// SPDX-License-Identifier: GPL-3.0-or-later
// Simulated ground truth, for demonstrations and tests: no information about people.
#pragma once

#include <cstdint>
#include <string_view>

#include "stages/core/options.h"
#include "stages/core/types.h"

namespace salbench {

struct SimulationOptions {
  std::int32_t participants = 23;
  std::int32_t picks = 10;    // mean per participant; each draws from half to one and a half times as many
  double random_share = 0.1;  // fraction of picks placed anywhere on the surface
  double separation = 0.05;   // least distance of a participant's picks, in square roots of the surface area
  double scale = 0.03;        // size of the bulges that attract picks, in the same unit
  double scatter = 0.01;      // distance of picks from the top of a bulge, in the same unit
  double sharpness = 3;       // a bulge's attraction is its height to this power

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("participants", self.participants,
          {"number of simulated participants", "participants", at_least(1)});
    visit("picks", self.picks, {"mean number of picks of a participant", "picks", at_least(1)});
    visit("random_share", self.random_share,
          {"picks that fall anywhere on the surface", "fraction of the picks", between(0, 1)});
    visit("separation", self.separation,
          {"least distance of a participant's picks", "sqrt(surface area)", at_least(0)});
    visit("scale", self.scale, {"size of the bulges that attract picks", "sqrt(surface area)", above(0)});
    visit("scatter", self.scatter,
          {"distance of picks from the top of a bulge", "sqrt(surface area)", at_least(0)});
    visit("sharpness", self.sharpness,
          {"power of a bulge that its share of the picks grows with", {}, at_least(0)});
  }
};

// Each participant picks distinct vertices, well separated, most of them near the tops of bulges, and some
// anywhere on the surface; saliency is smoothed_picks() of all. A participant who finds no more room on the
// mesh stops early. The result depends only on the options and on (seed, item), and participant k is
// independent of the number of others. Picks are uniform by area on a flat mesh, and uniform by vertex on a
// mesh without area. Throws InputError for a mesh without vertices.
GroundTruth simulated_ground_truth(const Mesh& mesh, const SimulationOptions& options, std::uint64_t seed,
                                   std::string_view item);

// Signed distance of each vertex from a smoothed copy of the surface, along its normal, in units of scale *
// sqrt(surface area); positive outside, on a mesh that is oriented outwards. The copy has diffused as far as
// a Gaussian of standard deviation sqrt(2) times that unit, independent of vertex density, so the result
// estimates 2 * mean curvature * unit. It is 0 at vertices without faces, and everywhere if the surface has
// no area.
ScalarField protrusion(const Mesh& mesh, double scale);

}  // namespace salbench
