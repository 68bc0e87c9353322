// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/local_maxima.h"

#include <algorithm>

#include "stages/core/check.h"
#include "stages/geometry/support.h"

namespace salbench {
namespace {

// The first point of each plateau that has no higher neighbour, but a lower one.
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
  // Sums are rounded: maxima of one height must not differ by that.
  const double least = options.height * sum / static_cast<double>(maxima.size()) * (1 - 1e-9);
  std::erase_if(maxima, [&](std::int32_t i) { return map[index(i)] < least; });
  return maxima;
}

}  // namespace salbench
