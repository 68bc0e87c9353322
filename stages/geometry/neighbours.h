// SPDX-License-Identifier: GPL-3.0-or-later
// Exact nearest-neighbour search over a fixed point set. [blanco2014]
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

struct Neighbour {
  std::int32_t index;
  double distance_squared;

  // True at the query's own position: callers divide by other distances.
  bool coincides() const { return distance_squared == 0; }
};

// Order of results; a lambda, so that sorting inlines it.
inline constexpr auto closer = [](const Neighbour& a, const Neighbour& b) {
  return a.distance_squared < b.distance_squared ||
         (a.distance_squared == b.distance_squared && a.index < b.index);
};

// The k nearest points of each of n points: computed once, used by several stages.
class NearestPoints {
 public:
  NearestPoints(std::size_t n, std::size_t k) : n_(n), k_(k), found_(n * k) {}
  std::size_t size() const { return n_; }
  std::size_t each() const { return k_; }

  std::span<const Neighbour> of(std::size_t point) const { return {&found_[point * k_], k_}; }
  std::span<Neighbour> of(std::size_t point) { return {&found_[point * k_], k_}; }

 private:
  std::size_t n_, k_;
  std::vector<Neighbour> found_;
};

// The points must outlive the tree. Results are ordered by (distance, index), so ties never depend on the
// tree's layout. Searches are const and may run on several threads. Throws InputError for a point that
// is not finite, and where squared distances from a query to its nearest points overflow.
class KdTree {
 public:
  explicit KdTree(std::span<const Vec3> points);
  // Restricts results to the members: indices of points, ascending. Results name points, not members.
  KdTree(std::span<const Vec3> points, std::vector<std::int32_t> members);
  KdTree(KdTree&&) noexcept;
  KdTree& operator=(KdTree&&) noexcept;
  ~KdTree();

  // The min(k, n) nearest points, including the query's own point if it is in the tree.
  void nearest(const Vec3& query, std::size_t k, std::vector<Neighbour>& found) const;
  std::int32_t nearest(const Vec3& query) const;  // index of the nearest point; n > 0

  NearestPoints nearest_of_each(std::span<const Vec3> queries, std::size_t k) const;

  // All points with distance <= radius.
  void within(const Vec3& query, double radius, std::vector<Neighbour>& found) const;
  void within_unordered(const Vec3& query, double radius, std::vector<Neighbour>& found) const;

  // Calls visit(i, found) once for each point i. `found`, unordered and valid during the call, are the points
  // within the radius around i that come later in the tree's order: each pair is visited once.
  using VisitPairs = std::function<void(std::int32_t i, std::span<const Neighbour> found)>;
  void pairs_within(double radius, const VisitPairs& visit) const;
  // Numbers of pairs within two radii, small <= large, in one search. nullopt if more than `most` are within
  // the large one; stops after about that many.
  std::optional<std::array<std::size_t, 2>> count_pairs_within(double small, double large,
                                                               std::size_t most) const;

  std::size_t size() const;                 // points in the tree
  bool contains(std::int32_t point) const;  // True if the tree contains the point. O(log n).

  // min(count, size()) of the points, following the density of the shape. Ascending.
  std::vector<std::int32_t> even_sample(std::size_t count) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Sets unknown values to that of the nearest point with a known one; false if there is none.
template <class Value, class Known>
bool fill_from_nearest(Points points, std::vector<Value>& values, const Known& known) {
  std::vector<std::int32_t> places;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (known(values[i])) places.push_back(static_cast<std::int32_t>(i));
  if (places.size() == values.size()) return true;
  if (places.empty()) return false;
  const KdTree tree(points, std::move(places));
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!known(values[i])) values[i] = values[static_cast<std::size_t>(tree.nearest(points[i]))];
  return true;
}

}  // namespace salbench
