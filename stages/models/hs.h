// HS, human performance: how well people predict what other people mark. What a model is measured against,
// and no model of a shape itself: it reads the picks of the participants, and only meshes have those.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "stages/core/options.h"
#include "stages/core/rng.h"
#include "stages/core/types.h"

namespace salbench {

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

inline constexpr std::size_t kFewestParticipants = 2;  // below, there is nobody to predict

// Scores the map of one group against the others: their map is `saliency`, their picks are `picks`. Both maps
// are smoothed_picks() without the division by participants, as they are: to normalise and match them is the
// scorer's part. Equal arguments must get equal scores.
struct GroupScorer {
  std::size_t n_metrics;  // values of the Scores that it makes
  std::function<Scores(const ScalarField& map, const GroundTruth& others)> score;
};

// Of both functions: a group that picked nothing has a map of zeros, and is scored; where the others picked
// nothing there is nothing to predict, and the comparison is left out. A metric is the mean over where it is
// defined, NaN where it never is; the counts are those of the mesh, all participants together. Both throw
// InputError for fewer than two participants, and for a pick that is no vertex.

// Each participant in turn against all the others; the mean over the participants, in whatever order they
// come (to rounding). [tasse2016]
Scores one_against_rest(const Mesh& mesh, const GroundTruth& truth, const GroupScorer& scorer);

// Entry n - 1: a random n participants against another n, disjoint; the mean over the draws. As long as
// there are 2n participants and n <= largest_group. The draws depend on `rng` and the number of participants
// alone, those for n not on largest_group. [tasse2016]
HumanCurve human_curve(const Mesh& mesh, const GroundTruth& truth, const HsOptions& options,
                       const GroupScorer& scorer, Rng rng);

}  // namespace salbench
