// SPDX-License-Identifier: GPL-3.0-or-later
// A group's map is a sum over the picks of its participants, so each pick is smoothed once for all groups.
#include "stages/models/hs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "stages/core/check.h"
#include "stages/core/errors.h"
#include "stages/core/field.h"
#include "stages/core/seen.h"
#include "stages/geometry/smoothing.h"

namespace salbench {
namespace {

using Group = std::span<const std::size_t>;  // distinct participants

// Mean of each metric over the comparisons in which it is defined.
class MeanOfScores {
 public:
  explicit MeanOfScores(std::size_t n_metrics) : sums_(n_metrics), counts_(n_metrics) {}

  void add(const Scores& scores) {
    CHECK_EQ(scores.values.size(), sums_.size());
    for (std::size_t m = 0; m < sums_.size(); ++m) {
      if (std::isnan(scores.values[m])) continue;
      sums_[m] += scores.values[m];
      ++counts_[m];
    }
  }

  // Means, with the counts of `scores`.
  Scores with_counts_of(Scores scores) const {
    scores.values.clear();
    for (std::size_t m = 0; m < sums_.size(); ++m)
      scores.values.push_back(counts_[m] > 0 ? sums_[m] / counts_[m]
                                             : std::numeric_limits<double>::quiet_NaN());
    return scores;
  }

 private:
  std::vector<double> sums_;  // [metric]
  std::vector<int> counts_;   // [metric], number of defined values
};

SmoothingOptions undivided() {
  SmoothingOptions options;
  options.per_participant = false;
  return options;
}

bool have_maps(const GroundTruth& truth) {
  const std::size_t people = truth.picks.size();
  return truth.viewers.size() >= kMinParticipants &&
         (people < kMinParticipants || people == truth.viewers.size());
}

void require_participants(const GroundTruth& truth) {
  if (truth.picks.size() < kMinParticipants && !have_maps(truth))
    throw ShapeError("HS does not apply: it compares participants with each other, and this mesh has " +
                     (truth.viewers.size() == 1 ? std::string("the map of one participant")
                      : truth.picks.empty()     ? std::string("no picks")
                                            : std::string("one list of picks (one participant, or pooled)")));
}

// Compares groups of the participants of one mesh.
class Participants {
 public:
  Participants(const Mesh& mesh, const GroundTruth& truth, const GroupScorer& scorer)
      : truth_(truth), scorer_(scorer) {
    if (!have_maps(truth)) smooth_.emplace(mesh, truth.picks, undivided());
    const auto seen = seen_points(truth.saliency);
    counts_.n_points = static_cast<std::int64_t>(seen ? seen->size() : mesh.vertices.size());
    counts_.n_picks = static_cast<std::int64_t>(picked_points(seen ? truth_at(truth, *seen) : truth).size());
  }

  std::size_t size() const { return smooth_ ? truth_.picks.size() : truth_.viewers.size(); }
  const Scores& counts() const { return counts_; }

  void compare(Group group, Group others, MeanOfScores& mean) const {
    GroundTruth predicted;
    predicted.simulated = truth_.simulated;
    if (truth_.picks.size() == size())
      for (const std::size_t k : others) predicted.picks.push_back(truth_.picks[k]);
    if (!smooth_) {
      predicted.saliency = mean_of_seen(truth_.viewers, others);
      mean.add(scorer_.score(mean_of_seen(truth_.viewers, group), predicted));
      return;
    }
    if (std::ranges::all_of(predicted.picks, [](const auto& own) { return own.empty(); })) return;
    predicted.saliency = (*smooth_)(others);
    for (std::size_t i = 0; i < predicted.saliency.size() && !truth_.saliency.empty(); ++i)
      if (std::isnan(truth_.saliency[i])) predicted.saliency[i] = truth_.saliency[i];
    mean.add(scorer_.score((*smooth_)(group), predicted));
  }

 private:
  const GroundTruth& truth_;
  const GroupScorer& scorer_;
  std::optional<PickSmoother> smooth_;  // nullopt: each participant has a map
  Scores counts_;                       // counts of the mesh, without metrics
};

std::vector<std::size_t> everyone(const Participants& participants) {
  std::vector<std::size_t> all(participants.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}

// Moves `count` random elements to the front, in random order (a partial Fisher-Yates shuffle).
void draw_to_front(std::vector<std::size_t>& elements, std::size_t count, Rng& rng) {
  for (std::size_t i = 0; i < count; ++i)
    std::swap(elements[i], elements[i + rng.below(elements.size() - i)]);
}

}  // namespace

Scores leave_one_out(const Mesh& mesh, const GroundTruth& truth, const GroupScorer& scorer) {
  require_participants(truth);
  const Participants participants(mesh, truth, scorer);
  std::vector<std::size_t> order = everyone(participants);
  MeanOfScores mean(scorer.n_metrics);
  for (std::size_t k = 0; k < order.size(); ++k) {
    std::swap(order.front(), order[k]);
    participants.compare(Group(order).first(1), Group(order).subspan(1), mean);
    std::swap(order.front(), order[k]);
  }
  return mean.with_counts_of(participants.counts());
}

HumanCurve human_curve(const Mesh& mesh, const GroundTruth& truth, const HsOptions& options,
                       const GroupScorer& scorer, Rng rng) {
  check(options);
  require_participants(truth);
  const Participants participants(mesh, truth, scorer);
  const std::size_t largest =
      std::min(static_cast<std::size_t>(options.largest_group), participants.size() / 2);
  HumanCurve curve;
  for (std::size_t n = 1; n <= largest; ++n) {
    std::vector<std::size_t> order = everyone(participants);
    MeanOfScores mean(scorer.n_metrics);
    for (std::int32_t draw = 0; draw < options.draws; ++draw) {
      draw_to_front(order, 2 * n, rng);
      participants.compare(Group(order).first(n), Group(order).subspan(n, n), mean);
    }
    curve.push_back(mean.with_counts_of(participants.counts()));
  }
  return curve;
}

}  // namespace salbench
