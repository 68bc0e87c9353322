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

  // True if it is where the query is: the distance between two points that are not is divided by.
  bool coincides() const { return distance_squared == 0; }
};

// The order of what is found; a lambda, which sorting inlines.
inline constexpr auto closer = [](const Neighbour& a, const Neighbour& b) {
  return a.distance_squared < b.distance_squared ||
         (a.distance_squared == b.distance_squared && a.index < b.index);
};

// The k points nearest to each of n: looked for once, read by several.
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
  // Finds only the members: indices of points, ascending. Results name points, not members.
  KdTree(std::span<const Vec3> points, std::vector<std::int32_t> members);
  KdTree(KdTree&&) noexcept;
  KdTree& operator=(KdTree&&) noexcept;
  ~KdTree();

  // The min(k, n) nearest points, the query's own point included if it is one of them.
  void nearest(const Vec3& query, std::size_t k, std::vector<Neighbour>& found) const;
  std::int32_t nearest(const Vec3& query) const;  // index of the nearest point; n > 0

  NearestPoints nearest_of_each(std::span<const Vec3> queries, std::size_t k) const;

  // All points with distance <= radius.
  void within(const Vec3& query, double radius, std::vector<Neighbour>& found) const;
  void within_unordered(const Vec3& query, double radius, std::vector<Neighbour>& found) const;

  // Calls visit(i, found) once for each point i. `found`, valid during the call and in no order, are the
  // points within the radius around i that come later in an order of the tree: each pair comes once.
  using VisitPairs = std::function<void(std::int32_t i, std::span<const Neighbour> found)>;
  void pairs_within(double radius, const VisitPairs& visit) const;
  // How many pairs there are, for two radii in one search; small <= large. Nothing if more than `most` are
  // within the large one, which is noticed after about so many.
  std::optional<std::array<std::size_t, 2>> count_pairs_within(double small, double large,
                                                               std::size_t most) const;

  std::size_t size() const;                 // points that can be found
  bool contains(std::int32_t point) const;  // True if the point can be found. O(log n).

  // min(count, size()) of the points, as dense or thin as the shape is there. Ascending.
  std::vector<std::int32_t> even_sample(std::size_t count) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// A value that is not known becomes that of the nearest point with one; false if none has.
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
