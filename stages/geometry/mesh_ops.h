// SPDX-License-Identifier: GPL-3.0-or-later
// Measures of a shape that several stages share.
#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

Vec3 centroid(std::span<const Vec3> points);  // mean of the points; n > 0

// True if all points are equal in every coordinate. Exact, since nothing is computed: all tests for an extent
// agree with it.
bool coincide(std::span<const Vec3> points);

// Reason why a shape is unusable for any computation: no points, a coordinate that is not finite or too
// large, all points in one place, or too small an extent. Empty if it is usable.
std::string wrong_with_extent(std::span<const Vec3> points);

// R of the benchmark: largest distance of a point to the centroid; 0 if all points coincide. [tasse2016]
double bounding_radius(std::span<const Vec3> points);

// Points relative to the centroid, in units of R. Coincident points remain coincident; points more than 1e-15
// R apart remain distinct. Throws InputError in the cases of wrong_with_extent.
std::vector<Vec3> in_units_of_radius(std::span<const Vec3> points);

// Throws InputError for a face whose point does not exist.
void check_faces(std::size_t n_points, Surface surface);

// (b - a) x (c - a): twice the area, along the face's normal.
Vec3 face_area_vector(Points points, const Triangle& face);
Vec3 face_area_vector(const Mesh& mesh, const Triangle& face);

// [vertex]: sum over its faces.
std::vector<Vec3> summed_area_vectors(const Mesh& mesh);

double surface_area(const Mesh& mesh);

// Barycentric areas: a third of the area of the faces at each point, 0 without faces. n; their sum is the
// area of the surface, and sum(area * field) is the integral of the field interpolated linearly over the
// faces.
ScalarField barycentric_areas(Points points, Surface surface);

Vec3 area_centroid(const Mesh& mesh);  // area-weighted mean of the face centres; the surface area is > 0

// Neighbours along edges in compressed rows: those of point i, sorted and distinct, are
// neighbours[offsets[i]] .. neighbours[offsets[i + 1] - 1].
struct Adjacency {
  std::vector<std::int32_t> offsets;  // n + 1
  std::vector<std::int32_t> neighbours;

  std::size_t size() const { return offsets.size() - 1; }
  std::span<const std::int32_t> of(std::size_t i) const {
    return {neighbours.data() + offsets[i], neighbours.data() + offsets[i + 1]};
  }
};

// Builds compressed rows: for_each_pair(visit) calls visit(i, neighbour) for each pair, possibly repeatedly.
template <class ForEachPair>
Adjacency adjacency_of(std::size_t n, const ForEachPair& for_each_pair) {
  std::vector<std::size_t> end(n + 1, 0);
  for_each_pair([&](std::size_t from, std::int32_t) { ++end[from + 1]; });
  std::partial_sum(end.begin(), end.end(), end.begin());
  std::vector<std::int32_t> all(end.back());
  for_each_pair([&](std::size_t from, std::int32_t to) { all[end[from]++] = to; });

  Adjacency adjacency{std::vector<std::int32_t>(n + 1, 0), {}};
  adjacency.neighbours.reserve(all.size() / 2);
  std::size_t begin = 0;
  for (std::size_t i = 0; i < n; begin = end[i++]) {
    const auto first = all.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last = all.begin() + static_cast<std::ptrdiff_t>(end[i]);
    std::sort(first, last);
    std::unique_copy(first, last, std::back_inserter(adjacency.neighbours));
    adjacency.offsets[i + 1] = static_cast<std::int32_t>(adjacency.neighbours.size());
  }
  return adjacency;
}

Adjacency edge_adjacency(std::size_t n_points, std::span<const Triangle> faces);

// Groups items by point, each group sorted by `less`. Groups are small: sorting each takes a fraction of the
// time of sorting everything.
template <class Item, class PointOf, class Less>
std::vector<Item> sorted_by_point(std::size_t n_points, const std::vector<Item>& items,
                                  const PointOf& point_of, const Less& less) {
  std::vector<std::size_t> ends(n_points + 1, 0);
  for (const Item& item : items) ++ends[index(point_of(item)) + 1];
  std::partial_sum(ends.begin(), ends.end(), ends.begin());
  std::vector<Item> sorted(items.size());
  for (const Item& item : items) sorted[ends[index(point_of(item))]++] = item;
  auto first = sorted.begin();
  for (const std::size_t end : ends) {
    const auto last = sorted.begin() + static_cast<std::ptrdiff_t>(end);
    std::sort(first, last, less);
    first = last;
  }
  return sorted;
}

// A side of a face, identified by the edge along which it lies.
struct EdgeSide {
  std::int32_t low, high;  // points, the lower one first
  std::int32_t face;
  bool upwards;  // the face traverses the edge from its lower to its higher point
};

// Sides of all faces, grouped by edge, then ordered by face.
std::vector<EdgeSide> edge_sides(std::size_t n_points, Surface faces);

// Calls visit(sides) for each edge.
template <class Visit>
void for_each_edge(std::span<const EdgeSide> sides, const Visit& visit) {
  for (auto first = sides.begin(); first != sides.end();) {
    const auto last = std::find_if(
        first, sides.end(), [&](const EdgeSide& s) { return s.low != first->low || s.high != first->high; });
    visit(std::span(first, last));
    first = last;
  }
}

// Label 0..c-1 of each point's connected component; components are numbered by their lowest point.
std::vector<std::int32_t> connected_components(const Adjacency& adjacency);

struct ReachedPoint {
  std::int32_t index;
  double distance;  // length of the shortest path
};

// Shortest paths along edges from a source, including the source, up to distance <= reach. The workspace is
// reused between calls on the same mesh, so the cost of a call depends only on the points reached.
class EdgeDistances {
 public:
  EdgeDistances(std::span<const Vec3> points, const Adjacency& adjacency);
  // Ordered by (distance, index); valid until the next call.
  std::span<const ReachedPoint> from(std::int32_t source, double reach);

 private:
  std::span<const Vec3> points_;
  const Adjacency& adjacency_;
  std::vector<double> distance_;  // infinity if not reached
  std::vector<ReachedPoint> reached_;
};

}  // namespace salbench
