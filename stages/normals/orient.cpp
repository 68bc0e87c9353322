// SPDX-License-Identifier: GPL-3.0-or-later
// CGAL builds the graph, finds its minimum spanning tree and propagates the orientation, but leaves parts
// without a seed unchanged. So the components are found here first, and each is passed to CGAL separately
// with its one seed. CGAL's graph has the edge (i, j), i < j, only if j is among the points nearest to i, not
// vice versa, and the same rule is used here.
#include "stages/normals/orient.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/mst_orient_normals.h>
#include <CGAL/property_map.h>

#include "stages/core/check.h"

namespace salbench {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;  // only compares distances: needs no exact predicates
using CloudPoint = std::tuple<Kernel::Point_3, Kernel::Vector_3, std::int32_t, bool>;
constexpr int kPosition = 0, kNormal = 1, kIndex = 2, kIsSeed = 3;
using Component = std::vector<std::int32_t>;  // ascending point indices

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0U); }
  std::size_t root(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::size_t i, std::size_t j) { parent_[root(i)] = root(j); }

 private:
  std::vector<std::size_t> parent_;
};

// One part per point; all except those of a root are empty.
std::vector<Component> connected_parts(const NearestPoints& near, const OrientationGraph& graph,
                                       const Normals& normals) {
  CHECK_EQ(near.size(), normals.size());
  const double longest_squared = graph.longest_edge * graph.longest_edge;
  const double least_cosine = std::cos(graph.largest_turn);
  DisjointSets sets(normals.size());
  for (std::size_t i = 0; i < normals.size(); ++i) {
    for (const Neighbour& n : near.of(i)) {
      const auto j = static_cast<std::size_t>(n.index);
      if (j > i && n.distance_squared <= longest_squared &&
          std::abs(normals[i].dot(normals[j])) >= least_cosine)
        sets.join(i, j);
    }
  }
  std::vector<Component> by_root(normals.size());
  for (std::size_t i = 0; i < normals.size(); ++i)
    by_root[sets.root(i)].push_back(static_cast<std::int32_t>(i));
  return by_root;
}

// Returns the points that the orientation did not reach, ascending.
Component pass_on(std::span<const Vec3> points, const Component& part, std::int32_t seed,
                  std::int32_t neighbours, Normals& normals) {
  std::vector<CloudPoint> cloud;
  cloud.reserve(part.size());
  for (const std::int32_t i : part) {
    const Vec3& p = points[static_cast<std::size_t>(i)];
    const Vec3& n = normals[static_cast<std::size_t>(i)];
    cloud.emplace_back(Kernel::Point_3(p.x(), p.y(), p.z()), Kernel::Vector_3(n.x(), n.y(), n.z()), i,
                       i == seed);
  }
  const auto unreached = CGAL::mst_orient_normals(
      cloud, static_cast<unsigned>(neighbours),
      CGAL::parameters::point_map(CGAL::Nth_of_tuple_property_map<kPosition, CloudPoint>())
          .normal_map(CGAL::Nth_of_tuple_property_map<kNormal, CloudPoint>())
          .point_is_constrained_map(CGAL::Nth_of_tuple_property_map<kIsSeed, CloudPoint>()));
  // CGAL has reordered the points, the reached ones first.
  Component left;
  for (auto p = cloud.begin(); p != cloud.end(); ++p) {
    const Kernel::Vector_3& n = std::get<kNormal>(*p);
    normals[static_cast<std::size_t>(std::get<kIndex>(*p))] = {n.x(), n.y(), n.z()};
    if (p >= unreached) left.push_back(std::get<kIndex>(*p));
  }
  return left;
}

}  // namespace

void orient_normals(std::span<const Vec3> points, const NearestPoints& near, const OrientationGraph& graph,
                    const SeedRule& seed_of, Normals& normals) {
  for (Component& part : connected_parts(near, graph, normals)) {
    // One pass usually suffices. CGAL may choose other neighbours than KdTree among equally distant ones, and
    // it stops at a right angle; the remaining points then form a part of their own. The loop ends because
    // each pass reaches at least the seed.
    while (!part.empty()) {
      const OrientationSeed seed = seed_of(part);
      Vec3& normal = normals[static_cast<std::size_t>(seed.point)];
      if (normal.dot(seed.towards) < 0) normal = -normal;
      part = part.size() == 1 ? Component() : pass_on(points, part, seed.point, graph.neighbours, normals);
    }
  }
}

}  // namespace salbench
