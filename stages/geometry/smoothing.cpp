// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/geometry/smoothing.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>

#include "stages/core/check.h"
#include "stages/core/errors.h"
#include "stages/core/field.h"
#include "stages/geometry/mesh_ops.h"
#include "stages/geometry/support.h"

namespace salbench {
namespace {

// Ascending and distinct.
std::vector<std::int32_t> picked_vertices(Picks picks, std::size_t n_vertices) {
  std::vector<std::int32_t> picked;
  for (std::size_t k = 0; k < picks.size(); ++k) {
    for (const std::int32_t vertex : picks[k]) {
      if (vertex < 0 || static_cast<std::size_t>(vertex) >= n_vertices)
        throw ShapeError("participant " + std::to_string(k) + " picked vertex " + std::to_string(vertex) +
                         " of a mesh with " + std::to_string(n_vertices) +
                         " vertices (0-based): the picks are those of another mesh");
      picked.push_back(vertex);
    }
  }
  sort_and_deduplicate(picked);
  return picked;
}

// Limit on the vertices within reach of picks, over all picks: 16 bytes each, and as many steps along edges.
// A statue of 20,000 vertices on a ground of two huge faces has all of them in reach of each of 300 picks.
constexpr double kMostOfAll = 1e7;

// Limit on the mean number of vertices that picks reach, if all picks together exceed the limit above: 1000
// or, if that is more, fifty times as many as even vertices in a disc of that radius, in square roots of the
// surface area. If the surface has a few huge faces, all others are in reach, and time and memory grow as all
// picks times all vertices.
double most_reached(std::size_t n_vertices, double reach) {
  constexpr double kMany = 1000, kUneven = 50;
  return std::max(kMany, kUneven * std::numbers::pi * reach * reach * static_cast<double>(n_vertices));
}

}  // namespace

PickSmoother::PickSmoother(const Mesh& mesh, Picks picks, const SmoothingOptions& options)
    : n_vertices_(mesh.vertices.size()), per_participant_(options.per_participant) {
  check(options);
  const std::vector<std::int32_t> picked = picked_vertices(picks, n_vertices_);
  for (std::vector<std::int32_t> own : picks) {
    sort_and_deduplicate(own);  // a participant's repetition counts once
    auto& sites = sites_of_.emplace_back();
    for (const std::int32_t vertex : own)
      sites.push_back(static_cast<std::size_t>(std::ranges::lower_bound(picked, vertex) - picked.begin()));
  }

  const double sigma = options.sigma * std::sqrt(surface_area(mesh));
  const Adjacency adjacency = edge_adjacency(n_vertices_, mesh.faces);
  EdgeDistances distances(mesh.vertices, adjacency);
  const double reach = options.cut * sigma, most = most_reached(n_vertices_, options.cut * options.sigma);
  double all = 0;
  for (const std::int32_t vertex : picked) {
    auto& gaussian = gaussians_.emplace_back();
    const std::span<const ReachedPoint> near = distances.from(vertex, reach);
    all += static_cast<double>(near.size());
    if (all > std::max(kMostOfAll, most * static_cast<double>(picked.size())))
      fail_with_many_neighbours(mesh.vertices, reach, most);
    for (const auto& [reached, distance] : near) {
      // If the mesh has no surface, sigma is 0 and only distance 0 is in reach.
      const double deviations = distance == 0 ? 0 : distance / sigma;
      gaussian.push_back({reached, std::exp(-deviations * deviations / 2)});
    }
  }
}

ScalarField PickSmoother::operator()(std::span<const std::size_t> participants) const {
  if (participants.empty() && per_participant_)
    throw ShapeError("no participants: the ground truth, a mean over participants, cannot be computed");
  std::vector<std::int32_t> counts(gaussians_.size(), 0);
  for (const std::size_t k : participants) {
    CHECK_LT(k, sites_of_.size());
    for (const std::size_t site : sites_of_[k]) ++counts[site];
  }
  // Summed per vertex, not per participant, so that the order of the participants has no effect.
  ScalarField field(n_vertices_, 0.0);
  for (std::size_t site = 0; site < counts.size(); ++site) {
    if (counts[site] == 0) continue;
    for (const auto& [vertex, value] : gaussians_[site])
      field[static_cast<std::size_t>(vertex)] += counts[site] * value;
  }
  if (per_participant_)
    for (double& value : field) value /= static_cast<double>(participants.size());
  return field;
}

ScalarField smoothed_picks(const Mesh& mesh, Picks picks, const SmoothingOptions& options) {
  std::vector<std::size_t> everyone(picks.size());
  std::iota(everyone.begin(), everyone.end(), std::size_t{0});
  return PickSmoother(mesh, picks, options)(everyone);
}

}  // namespace salbench
