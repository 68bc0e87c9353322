// SPDX-License-Identifier: GPL-3.0-or-later
// People asked for points that others would also choose agree on tips, corners and other places that stand
// out from their surroundings [chen2012]. So the bulges of the surface have tops, each participant draws
// among them in proportion to a power of the bulge, and picks a vertex nearby.
#include "stages/ground_truth/simulation.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "stages/core/errors.h"
#include "stages/core/rng.h"
#include "stages/geometry/mesh_ops.h"
#include "stages/geometry/smoothing.h"

namespace salbench {
namespace {

constexpr double kFlat = 1e-9;   // smaller bulges, in units of their scale, are rounding errors
constexpr double kHollow = 0.5;  // attraction of a hollow, relative to an equal bulge
constexpr int kMaxTries = 64;    // consecutive draws, too close to earlier picks, until a participant stops

// Draws indices with probability proportional to their weights; requires at least one weight.
class WeightedDraw {
 public:
  explicit WeightedDraw(const std::vector<double>& weights) : cumulative_(weights.size()) {
    std::partial_sum(weights.begin(), weights.end(), cumulative_.begin());
  }
  bool all_zero() const { return cumulative_.back() == 0; }
  std::int32_t operator()(Rng& rng) const {
    const double target = rng.uniform() * cumulative_.back();
    const auto found = std::ranges::upper_bound(cumulative_, target);
    // The product may be rounded up to the total.
    return static_cast<std::int32_t>(std::min(found, std::prev(cumulative_.end())) - cumulative_.begin());
  }

 private:
  std::vector<double> cumulative_;
};

// A third of the area of the incident faces; 1 everywhere if no face has an area.
std::vector<double> vertex_areas(const Mesh& mesh) {
  std::vector<double> areas = barycentric_areas(mesh.vertices, mesh.faces);
  if (*std::ranges::max_element(areas) == 0) std::ranges::fill(areas, 1.0);
  return areas;
}

// Attraction of each vertex for picks, at most 1; 0 everywhere on a flat mesh.
ScalarField attraction(const Mesh& mesh, const SimulationOptions& options) {
  ScalarField field = protrusion(mesh, options.scale);
  for (double& value : field) value = std::max(value, -kHollow * value);
  const double largest = *std::ranges::max_element(field);
  for (double& value : field) value = value < kFlat ? 0 : std::pow(value / largest, options.sharpness);
  return field;
}

// Keeps the maxima of a field that are out of reach of every greater one; sets all other values to 0.
ScalarField tops_of(const ScalarField& field, EdgeDistances& distances, double reach) {
  std::vector<std::int32_t> order(field.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order,
                           [&](std::int32_t a, std::int32_t b) { return field[index(a)] > field[index(b)]; });
  ScalarField tops(field.size(), 0.0);
  std::vector<bool> covered(field.size(), false);
  for (const std::int32_t vertex : order) {
    if (field[index(vertex)] == 0) break;
    if (covered[index(vertex)]) continue;
    tops[index(vertex)] = field[index(vertex)];
    for (const ReachedPoint& near : distances.from(vertex, reach)) covered[index(near.index)] = true;
  }
  return tops;
}

// Draws the picks of a mesh's participants, one after another.
class Picker {
 public:
  Picker(const Mesh& mesh, const SimulationOptions& options)
      : options_(options),
        unit_(std::sqrt(surface_area(mesh))),
        adjacency_(edge_adjacency(mesh.vertices.size(), mesh.faces)),
        distances_(mesh.vertices, adjacency_),
        anywhere_(vertex_areas(mesh)),
        tops_(tops_of(attraction(mesh, options), distances_, options.separation * unit_)),
        taken_(mesh.vertices.size()) {}

  std::vector<std::int32_t> picks_of_one(Rng& rng) {
    const auto mean = static_cast<std::uint64_t>(options_.picks);
    const std::uint64_t least = (mean + 1) / 2;
    const std::uint64_t wanted = least + rng.below(2 * (mean - least) + 1);  // uniform around the mean
    taken_.assign(taken_.size(), false);
    std::vector<std::int32_t> picks;
    int failed = 0;
    while (picks.size() < wanted && failed < kMaxTries) {
      const std::int32_t vertex = candidate(rng);
      if (taken_[index(vertex)]) {
        ++failed;
        continue;
      }
      failed = 0;
      picks.push_back(vertex);
      for (const ReachedPoint& near : distances_.from(vertex, options_.separation * unit_))
        taken_[index(near.index)] = true;
    }
    return picks;
  }

 private:
  std::int32_t candidate(Rng& rng) {
    if (tops_.all_zero() || rng.uniform() < options_.random_share) return anywhere_(rng);
    const std::int32_t top = tops_(rng);
    const auto around = distances_.from(top, options_.scatter * unit_ * std::abs(rng.normal()));
    return around[rng.below(around.size())].index;
  }

  SimulationOptions options_;
  double unit_;  // square root of the surface area
  Adjacency adjacency_;
  EdgeDistances distances_;
  WeightedDraw anywhere_, tops_;
  std::vector<bool> taken_;  // too close to a pick of the current participant
};

}  // namespace

GroundTruth simulated_ground_truth(const Mesh& mesh, const SimulationOptions& options, std::uint64_t seed,
                                   std::string_view item) {
  check(options);
  if (mesh.vertices.empty()) throw ShapeError("the mesh has no vertices: picks cannot be simulated");
  Picker picker(mesh, options);
  GroundTruth truth;
  truth.simulated = true;
  for (std::int32_t k = 0; k < options.participants; ++k) {
    Rng rng(seed, "simulated_picks", std::string(item) + "/" + std::to_string(k));
    truth.picks.push_back(picker.picks_of_one(rng));
  }
  truth.saliency = smoothed_picks(mesh, truth.picks);
  return truth;
}

}  // namespace salbench
