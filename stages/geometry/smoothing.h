// SPDX-License-Identifier: GPL-3.0-or-later
// Ground-truth saliency over a mesh, from the vertices picked by participants.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "stages/core/options.h"
#include "stages/core/types.h"

namespace salbench {

struct SmoothingOptions {
  double sigma = 0.01;          // standard deviation of the Gaussian, in square roots of the surface area
  double cut = 3;               // reach of the Gaussian, in standard deviations
  bool per_participant = true;  // divide by the number of participants

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("sigma", self.sigma, {"standard deviation of a pick's Gaussian", "sqrt(surface area)", above(0)});
    visit("cut", self.cut, {"reach of a pick's Gaussian", "standard deviations", above(0)});
    visit("per_participant", self.per_participant, {"divide by the number of participants"});
  }
};

using Picks = std::span<const std::vector<std::int32_t>>;  // picked vertices, per participant

// val(v) = (1/P) sum_k count_k exp(-d(v, k)^2 / (2 s^2)), cut at d <= 3 s, where d is the shortest path along
// edges, s = 0.01 sqrt(surface area), P the number of participants, including those without a pick, and
// count_k the number of participants who picked vertex k. [chen2012]
//
// n, one value per vertex; independent of the order of participants or picks. Throws InputError for a pick
// outside the mesh, if the result is divided by the number of participants and there are none, and if faces
// of extremely uneven size make picks reach too many vertices.
ScalarField smoothed_picks(const Mesh& mesh, Picks picks, const SmoothingOptions& options = {});

// The same for any group of the participants, bit for bit. Each pick's Gaussian is computed once and kept, so
// the map of a group costs only the additions. Thread-safe.
class PickSmoother {
 public:
  PickSmoother(const Mesh& mesh, Picks picks, const SmoothingOptions& options = {});

  ScalarField operator()(std::span<const std::size_t> participants) const;  // distinct, in any order

 private:
  struct Weight {
    std::int32_t vertex;
    double value;  // value of the Gaussian, in (0, 1]
  };

  std::size_t n_vertices_;
  bool per_participant_;
  std::vector<std::vector<std::size_t>> sites_of_;  // per participant: distinct, indices of picked vertices
  std::vector<std::vector<Weight>> gaussians_;      // per picked vertex, ascending: its reach
};

}  // namespace salbench
