// SPDX-License-Identifier: GPL-3.0-or-later
// A detected point matches the marked point nearest to it, within the tolerance: a single search from all
// marked points finds these.
#include "stages/metrics/interest_points.h"

#include <algorithm>
#include <vector>

#include "stages/core/check.h"
#include "stages/geometry/support.h"

namespace salbench {
namespace {

// Distinct points with their multiplicities.
struct Marked {
  std::vector<std::int32_t> points;
  std::vector<double> times;
};

Marked counted(std::span<const std::int32_t> marked) {
  Marked found;
  for (const std::int32_t i : marked) {
    if (found.points.empty() || found.points.back() != i) {
      found.points.push_back(i);
      found.times.push_back(0);
    }
    ++found.times.back();
  }
  return found;
}

}  // namespace

InterestPointScores interest_point_scores(std::span<const std::int32_t> detected,
                                          std::span<const std::int32_t> marked, const SurfaceGraph& graph,
                                          double tolerance) {
  InterestPointScores scores;
  if (marked.empty()) return scores;
  const Marked truth = counted(marked);
  const auto nearest_marked = nearest_sources(graph, truth.points, tolerance * graph.diameter);
  std::vector<bool> correct(truth.points.size());
  for (const std::int32_t i : detected)
    if (const std::int32_t source = nearest_marked[index(i)].source; source >= 0)
      correct[index(source)] = true;
  double n_correct = 0, times_correct = 0;
  for (std::size_t k = 0; k < correct.size(); ++k) {
    n_correct += correct[k] ? 1 : 0;
    times_correct += correct[k] ? truth.times[k] : 0;
  }
  scores.fne = 1 - n_correct / static_cast<double>(truth.points.size());
  scores.wme = 1 - times_correct / static_cast<double>(marked.size());
  scores.fpe = 1 - n_correct / std::max(1.0, static_cast<double>(detected.size()));
  return scores;
}

namespace {

// First point of each plateau that has no higher neighbour, but a lower one.
std::vector<std::int32_t> plateau_tops(std::span<const double> map, const Adjacency& edges) {
  std::vector<std::int32_t> tops;
  std::vector<bool> visited(map.size());
  std::vector<std::size_t> open;
  for (std::size_t first = 0; first < map.size(); ++first) {
    if (visited[first]) continue;
    visited[first] = true;
    bool any_higher = false, any_lower = false;
    for (open = {first}; !open.empty();) {
      const std::size_t i = open.back();
      open.pop_back();
      for (const std::int32_t j : edges.of(i)) {
        any_higher |= map[index(j)] > map[i];
        any_lower |= map[index(j)] < map[i];
        if (map[index(j)] != map[i] || visited[index(j)]) continue;
        visited[index(j)] = true;
        open.push_back(index(j));
      }
    }
    if (any_lower && !any_higher) tops.push_back(static_cast<std::int32_t>(first));
  }
  return tops;
}

}  // namespace

std::vector<std::int32_t> local_maxima(std::span<const double> map, const SurfaceGraph& graph,
                                       const LocalMaximaOptions& options) {
  CHECK_EQ(map.size(), graph.edges.size());
  std::vector<std::int32_t> maxima = plateau_tops(map, graph.edges);
  if (options.radius > 0) {
    EdgeDistances distances(graph.points, graph.edges);
    const double reach = options.radius * graph.radius,
                 most = most_mean_neighbours(map.size(), options.radius, 1);
    double all = 0, most_of_all = most * static_cast<double>(maxima.size());
    std::erase_if(maxima, [&](std::int32_t i) {
      const std::span<const ReachedPoint> near = distances.from(i, reach);
      all += static_cast<double>(near.size());
      if (all > most_of_all) fail_with_many_neighbours(graph.points, reach, most);
      return std::ranges::any_of(near, [&](const ReachedPoint& reached) {
        const double value = map[index(reached.index)];
        return value > map[index(i)] || (value == map[index(i)] && reached.index < i);
      });
    });
  }
  double sum = 0;
  for (const std::int32_t i : maxima) sum += map[index(i)];
  // Tolerates rounding of the sum: maxima of equal height must be treated alike.
  const double least = options.height * sum / static_cast<double>(maxima.size()) * (1 - 1e-9);
  std::erase_if(maxima, [&](std::int32_t i) { return map[index(i)] < least; });
  return maxima;
}

}  // namespace salbench
