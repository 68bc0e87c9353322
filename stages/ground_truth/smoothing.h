// From the points that people picked to a saliency over the mesh.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "stages/core/mesh_ops.h"
#include "stages/core/types.h"

namespace salbench {

struct SmoothingOptions {
  double sigma = 0.01;          // standard deviation of the Gaussian, in square roots of the surface area
  double cut = 3;               // reach of the Gaussian, in standard deviations
  bool per_participant = true;  // divide by the number of participants

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("sigma", self.sigma,
          "standard deviation of a pick's Gaussian, in square roots of the surface area");
    visit("cut", self.cut, "reach of a pick's Gaussian, in standard deviations");
    visit("per_participant", self.per_participant, "divide by the number of participants");
  }
};
void check(const SmoothingOptions& options);

using Picks = std::span<const std::vector<std::int32_t>>;  // per participant: the vertices picked

// val(v) = (1/P) sum_k count_k exp(-d(v, k)^2 / (2 s^2)), cut at d <= 3 s, where d is the shortest path along
// edges, s = 0.01 sqrt(surface area), P the number of participants, those without a pick included, and
// count_k how many of them picked vertex k. [chen2012]
//
// Holds what all groups of participants on one mesh share; the mesh must outlive it. Safe to share between
// threads.
class PickSmoother {
 public:
  explicit PickSmoother(const Mesh& mesh, const SmoothingOptions& options = {});

  // n, one value per vertex; does not depend on the order of participants or picks. Throws InputError for a
  // pick that is no vertex, and for no participants at all where the result is per participant.
  ScalarField operator()(Picks picks) const;

 private:
  const Mesh& mesh_;
  Adjacency adjacency_;
  SmoothingOptions options_;
  double sigma_;  // in the mesh's unit
};

ScalarField smoothed_picks(const Mesh& mesh, Picks picks, const SmoothingOptions& options = {});

}  // namespace salbench
