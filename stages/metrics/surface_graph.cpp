// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/surface_graph.h"

#include <queue>
#include <tuple>

namespace salbench {

SurfaceGraph surface_graph(Points points, Surface surface) {
  check_faces(points.size(), surface);
  return {{points.begin(), points.end()},
          edge_adjacency(points.size(), surface),
          points.empty() ? 0 : bounding_radius(points),
          diameter_of(points)};
}

SurfaceGraph SurfaceGraph::at(std::span<const std::int32_t> some) const {
  SurfaceGraph graph{{}, {{0}, {}}, radius, diameter};
  std::vector<std::int32_t> place(points.size(), -1);
  for (std::size_t k = 0; k < some.size(); ++k) place[index(some[k])] = static_cast<std::int32_t>(k);
  for (const std::int32_t i : some) {
    graph.points.push_back(points[index(i)]);
    for (const std::int32_t j : edges.of(index(i)))
      if (place[index(j)] >= 0) graph.edges.neighbours.push_back(place[index(j)]);
    graph.edges.offsets.push_back(static_cast<std::int32_t>(graph.edges.neighbours.size()));
  }
  return graph;
}

std::vector<NearestSource> nearest_sources(const SurfaceGraph& graph, std::span<const std::int32_t> sources,
                                           double reach) {
  std::vector<NearestSource> nearest(graph.points.size());
  // Dijkstra with lazy deletion; ties go to the lower source.
  using Entry = std::tuple<double, std::int32_t, std::int32_t>;  // distance, source, point
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  const auto offer = [&](double distance, std::int32_t source, std::int32_t point) {
    NearestSource& best = nearest[index(point)];
    if (distance > reach || distance > best.distance || (distance == best.distance && source >= best.source))
      return;
    best = {source, distance};
    open.emplace(distance, source, point);
  };
  for (std::size_t k = 0; k < sources.size(); ++k) offer(0, static_cast<std::int32_t>(k), sources[k]);
  while (!open.empty()) {
    const auto [distance, source, point] = open.top();
    open.pop();
    if (source != nearest[index(point)].source || distance > nearest[index(point)].distance) continue;
    for (const std::int32_t next : graph.edges.of(index(point)))
      offer(distance + (graph.points[index(point)] - graph.points[index(next)]).norm(), source, next);
  }
  return nearest;
}

}  // namespace salbench
