#include "stages/ground_truth/smoothing.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "stages/core/errors.h"

namespace salbench {
namespace {

void require_positive(const char* key, double value) {
  if (!(value > 0 && std::isfinite(value)))
    throw OptionError(key, "must be a positive number, not " + std::to_string(value));
}

// How many participants picked each vertex, a participant's repetition counting once.
std::vector<std::int32_t> participants_per_vertex(Picks picks, std::size_t n_vertices) {
  std::vector<std::int32_t> counts(n_vertices, 0);
  std::vector<std::int32_t> distinct;
  for (std::size_t k = 0; k < picks.size(); ++k) {
    distinct = picks[k];
    std::sort(distinct.begin(), distinct.end());
    distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
    for (const std::int32_t vertex : distinct) {
      if (vertex < 0 || static_cast<std::size_t>(vertex) >= n_vertices)
        throw InputError("participant " + std::to_string(k) + " picked vertex " + std::to_string(vertex) +
                         " of a mesh with " + std::to_string(n_vertices) + " vertices");
      ++counts[static_cast<std::size_t>(vertex)];
    }
  }
  return counts;
}

}  // namespace

void check(const SmoothingOptions& options) {
  require_positive("sigma", options.sigma);
  require_positive("cut", options.cut);
}

PickSmoother::PickSmoother(const Mesh& mesh, const SmoothingOptions& options)
    : mesh_(mesh),
      adjacency_(edge_adjacency(mesh.vertices.size(), mesh.faces)),
      options_(options),
      sigma_(options.sigma * std::sqrt(surface_area(mesh))) {
  check(options);
}

ScalarField PickSmoother::operator()(Picks picks) const {
  if (picks.empty() && options_.per_participant)
    throw InputError("no participant picked anything on this mesh: there is no ground truth to compute");
  const std::vector<std::int32_t> counts = participants_per_vertex(picks, mesh_.vertices.size());
  ScalarField field(mesh_.vertices.size(), 0.0);
  EdgeDistances distances(mesh_.vertices, adjacency_);
  for (std::size_t k = 0; k < counts.size(); ++k) {
    if (counts[k] == 0) continue;
    for (const auto& [vertex, distance] :
         distances.from(static_cast<std::int32_t>(k), options_.cut * sigma_)) {
      // Where the mesh has no surface, sigma is 0 and only distance 0 is in reach.
      const double deviations = distance == 0 ? 0 : distance / sigma_;
      field[static_cast<std::size_t>(vertex)] += counts[k] * std::exp(-deviations * deviations / 2);
    }
  }
  if (options_.per_participant)
    for (double& value : field) value /= static_cast<double>(picks.size());
  return field;
}

ScalarField smoothed_picks(const Mesh& mesh, Picks picks, const SmoothingOptions& options) {
  return PickSmoother(mesh, options)(picks);
}

}  // namespace salbench
