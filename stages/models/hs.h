// SPDX-License-Identifier: GPL-3.0-or-later
// HS, human performance: how well participants predict other participants' marks, as the reference for
// models. It reads the picks or maps of each participant, which only meshes have.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "stages/core/options.h"
#include "stages/core/rng.h"
#include "stages/core/types.h"
#include "stages/models/about.h"

namespace salbench {

inline constexpr ModelAbout kHsAbout = {
    .name = "Human performance: the marks of one participant, scored against those of all others",
    .by_default = true,
    .is_reference = true,
};

struct HsOptions {
  std::int32_t draws = 20;
  std::int32_t largest_group = 11;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(
        "draws", self.draws,
        {"random pairs of groups that each point of the human curve is averaged over", "pairs", at_least(1)});
    visit("largest_group", self.largest_group,
          {"size of a group at the end of the human curve", "participants", at_least(1)});
  }
};

inline constexpr std::size_t kMinParticipants = 2;  // one predicts, one is predicted

// Scores the map of one group of participants against another group, whose map and picks are in `others`.
// Both maps are smoothed_picks() without the division by participants; or, if every participant is a viewer
// with a map of their own (or nobody has picks), the mean of these at points that they have seen, NaN
// elsewhere. The scorer normalises and matches them. Equal arguments must get equal scores.
struct GroupScorer {
  std::size_t n_metrics;  // number of values in its Scores
  std::function<Scores(const ScalarField& map, const GroundTruth& others)> score;
};

// Both functions score a group without picks: its map is all zeros. They skip comparisons with others who
// picked nothing, since there is nothing to predict. Each metric is the mean over the comparisons in which it
// is defined, NaN if there are none; the counts are those of the mesh with all participants. Both throw
// InputError for fewer than two participants, and for a pick outside the mesh.

// Mean over all participants of one against all the others. Independent of their order, up to rounding.
// [tasse2016]
Scores leave_one_out(const Mesh& mesh, const GroundTruth& truth, const GroupScorer& scorer);

// Entry n - 1: mean over random draws of n participants against n others, for each n with 2n participants and
// n <= largest_group. Draws depend only on `rng` and the number of participants; those for n do not depend on
// largest_group. [tasse2016]
HumanCurve human_curve(const Mesh& mesh, const GroundTruth& truth, const HsOptions& options,
                       const GroupScorer& scorer, Rng rng);

}  // namespace salbench
