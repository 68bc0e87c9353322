// SPDX-License-Identifier: GPL-3.0-or-later
// Searches read copies of the coordinates in the tree's order, one leaf at a time. Results do not depend on
// that order, since ties are broken by index.
#include "stages/geometry/neighbours.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "stages/core/check.h"
#include "stages/core/errors.h"
#include "stages/core/field.h"
#include "stages/core/parallel.h"
#include "stages/geometry/kd_nodes.h"

namespace salbench {
namespace {

constexpr std::size_t kMany = 64;
constexpr std::size_t kLeafGrain = kPointGrain / kLeaf;

// Widened by more than the rounding error of a box's distance, even for a limit of 0: points exactly at the
// limit are found.
double widened(double limit) { return limit * (1 + 1e-12) + std::numeric_limits<double>::min(); }

// Points of one leaf.
struct Leaf {
  std::size_t count;
  const std::int32_t* index;
  std::array<double, kLeaf> distance_squared;
};

// Result sets: limit() bounds the search, take() consumes the points of a leaf.

// Keeps the k best by (distance, index) in a sorted array.
class NearestSet {
 public:
  NearestSet(std::vector<Neighbour>& best, std::size_t k) : best_(best), k_(k) { best_.clear(); }
  double limit() const {
    return best_.size() == k_ ? best_.back().distance_squared : std::numeric_limits<double>::max();
  }
  void take(const Leaf& leaf) {
    for (std::size_t i = 0; i < leaf.count; ++i)
      if (leaf.distance_squared[i] <= limit()) insert({leaf.index[i], leaf.distance_squared[i]});
  }

 private:
  void insert(const Neighbour& candidate) {
    if (best_.size() < k_)
      best_.push_back(candidate);
    else if (!closer(candidate, best_.back()))
      return;
    auto place = best_.end() - 1;
    for (; place != best_.begin() && closer(candidate, place[-1]); --place) *place = place[-1];
    *place = candidate;
  }

  std::vector<Neighbour>& best_;
  std::size_t k_;
};

// The same for large k, where insertion into a sorted array would dominate: keeps up to 2 k candidates, and
// drops the worse half when full.
class ManyNearestSet {
 public:
  ManyNearestSet(std::vector<Neighbour>& best, std::size_t k) : best_(best), k_(k) {
    best_.clear();
    best_.reserve(2 * k);
  }
  double limit() const { return limit_; }
  void take(const Leaf& leaf) {
    for (std::size_t i = 0; i < leaf.count; ++i) {
      if (!(leaf.distance_squared[i] <= limit_)) continue;
      best_.push_back({leaf.index[i], leaf.distance_squared[i]});
      if (best_.size() == 2 * k_) keep_the_best();
    }
  }
  void finish() {
    if (best_.size() > k_) keep_the_best();
    std::ranges::sort(best_, closer);
  }

 private:
  void keep_the_best() {
    const auto last = best_.begin() + static_cast<std::ptrdiff_t>(k_ - 1);
    std::nth_element(best_.begin(), last, best_.end(), closer);
    limit_ = last->distance_squared;
    best_.resize(k_);
  }

  std::vector<Neighbour>& best_;
  std::size_t k_;
  double limit_ = std::numeric_limits<double>::max();  // distance of the k-th so far
};

class WithinSet {
 public:
  WithinSet(std::vector<Neighbour>& found, double radius_squared)
      : found_(found), radius_squared_(radius_squared) {}
  double limit() const { return radius_squared_; }
  // Branch-free: writes each candidate, to be overwritten by the next if it is too far away.
  void take(const Leaf& leaf) {
    if (found_.size() < count_ + kLeaf) found_.resize(2 * (count_ + kLeaf));
    Neighbour* const end = found_.data() + count_;
    std::size_t taken = 0;
    for (std::size_t i = 0; i < leaf.count; ++i) {
      end[taken] = {leaf.index[i], leaf.distance_squared[i]};
      taken += leaf.distance_squared[i] <= radius_squared_;
    }
    count_ += taken;
  }
  void finish() { found_.resize(count_); }

 private:
  std::vector<Neighbour>& found_;
  std::size_t count_ = 0;
  double radius_squared_;
};

// A tree cannot hold non-finite points.
std::span<const Vec3> finite(std::span<const Vec3> points) {
  require_finite(points);
  return points;
}

std::vector<std::int32_t> all_of(std::span<const Vec3> points) {
  std::vector<std::int32_t> indices(points.size());
  std::iota(indices.begin(), indices.end(), 0);
  return indices;
}

}  // namespace

struct KdTree::Impl {
  std::vector<std::int32_t> members;  // ascending
  KdNodes tree;
  std::vector<double> x, y, z;  // in the tree's order, padded by one leaf that is read but not used

  // Points of a leaf, by place.
  struct Range {
    std::size_t first, last;
  };
  std::vector<Range> leaves;

  Impl(std::span<const Vec3> points, std::vector<std::int32_t> of)
      : members(std::move(of)), tree(kd_nodes(finite(points), members)) {
    for (auto* coordinates : {&x, &y, &z}) coordinates->reserve(size() + kLeaf);
    for (const std::int32_t i : tree.order) {
      const Vec3& point = points[static_cast<std::size_t>(i)];
      x.push_back(point.x());
      y.push_back(point.y());
      z.push_back(point.z());
    }
    for (auto* coordinates : {&x, &y, &z}) coordinates->resize(size() + kLeaf);
    for (const KdNode& node : tree.nodes)
      if (node.is_leaf()) leaves.push_back({node.first, node.last});
  }

  std::size_t size() const { return tree.order.size(); }

  template <class Set>
  void search(Set& set, const Vec3& query) const {
    if (size() == 0) return;
    // Squared distances from the box of all points, along the axes.
    Vec3 outside = (tree.low - query).cwiseMax(query - tree.high).cwiseMax(0.0).cwiseAbs2();
    descend(set, query, tree.nodes.front(), outside.sum(), outside);
  }

  // `least` and `outside`: squared distance from the node's box, in total and per axis.
  template <class Set>
  void descend(Set& set, const Vec3& query, const KdNode& node, double least, Vec3& outside) const {
    if (node.is_leaf()) return set.take(leaf(node.first, node.last, query));
    const double to_low = query[node.axis] - node.low, to_high = query[node.axis] - node.high;
    const bool in_near = to_low + to_high < 0;
    descend(set, query, in_near ? node.near_child() : node.far_child(), least, outside);
    const double across = in_near ? to_high * to_high : to_low * to_low;
    const double least_beyond = least + across - outside[node.axis];
    if (least_beyond > widened(set.limit())) return;
    const double before = std::exchange(outside[node.axis], across);
    descend(set, query, in_near ? node.far_child() : node.near_child(), least_beyond, outside);
    outside[node.axis] = before;
  }

  struct Box {
    Vec3 low, high;
  };

  Box box_of(const Range& range) const {
    Box box{point(range.first), point(range.first)};
    for (std::size_t i = range.first + 1; i < range.last; ++i) {
      box.low = box.low.cwiseMin(point(i));
      box.high = box.high.cwiseMax(point(i));
    }
    return box;
  }

  // Adds leaves from `first` on that are within the limit of the box. `least` and `outside` as in descend.
  void leaves_near(const Box& box, double limit, const KdNode& node, double least, Vec3& outside,
                   std::size_t first, std::vector<Range>& near) const {
    if (node.is_leaf()) {
      if (node.first >= first) near.push_back({node.first, node.last});
      return;
    }
    const std::array beyond = {std::max(box.low[node.axis] - node.low, 0.0),
                               std::max(node.high - box.high[node.axis], 0.0)};
    const std::array children = {&node.near_child(), &node.far_child()};
    for (std::size_t child = 0; child < 2; ++child) {
      const double across = std::max(beyond[child] * beyond[child], outside[node.axis]);
      const double least_there = least + across - outside[node.axis];
      if (least_there > limit) continue;
      const double before = std::exchange(outside[node.axis], across);
      leaves_near(box, limit, *children[child], least_there, outside, first, near);
      outside[node.axis] = before;
    }
  }

  // Calls body(i, near) for each place i of a leaf: `near` covers all later points within the limit, and
  // others. Traverses the tree once per leaf.
  template <class Body>
  void for_each_with_later(const Range& own, double limit, std::vector<Range>& near, const Body& body) const {
    near.clear();
    Vec3 outside = Vec3::Zero();
    leaves_near(box_of(own), widened(limit), tree.nodes.front(), 0, outside, own.first, near);
    for (std::size_t i = own.first; i < own.last; ++i) {
      near.front().first = i + 1;  // the leaf itself
      body(i, near);
    }
  }

  void pairs_within(double radius, const VisitPairs& visit) const {
    const double limit = radius * radius;
    std::vector<Range> near;
    std::vector<Neighbour> found;
    for (const Range& own : leaves)
      for_each_with_later(own, limit, near, [&](std::size_t i, const std::vector<Range>& later) {
        WithinSet set(found, limit);
        for (const Range& range : later) set.take(leaf(range.first, range.last, point(i)));
        set.finish();
        visit(tree.order[i], found);
      });
  }

  std::optional<std::array<std::size_t, 2>> count_pairs_within(double small, double large,
                                                               std::size_t most) const {
    const std::array limits = {small * small, large * large};
    std::array<std::atomic<std::size_t>, 2> pairs = {0, 0};
    parallel_ranges(leaves.size(), kLeafGrain, [&](std::size_t first, std::size_t last) {
      std::vector<Range> near;
      for (std::size_t own = first; own < last && pairs[1] <= most; ++own) {
        std::array<std::size_t, 2> some = {0, 0};
        for_each_with_later(leaves[own], limits[1], near,
                            [&](std::size_t i, const std::vector<Range>& later) {
                              for (const Range& range : later) {
                                const Leaf there = leaf(range.first, range.last, point(i));
                                for (std::size_t j = 0; j < there.count; ++j)
                                  for (std::size_t r = 0; r < 2; ++r)
                                    some[r] += there.distance_squared[j] <= limits[r];
                              }
                            });
        for (std::size_t r = 0; r < 2; ++r) pairs[r] += some[r];
      }
    });
    if (pairs[1] > most) return {};
    return {{pairs[0], pairs[1]}};
  }

  Vec3 point(std::size_t place) const { return {x[place], y[place], z[place]}; }

  Leaf leaf(std::size_t first, std::size_t last, const Vec3& query) const {
    Leaf leaf;
    leaf.count = last - first;
    leaf.index = tree.order.data() + first;
    for (std::size_t i = 0; i < kLeaf; ++i) {  // reads past the leaf: a loop of fixed length is faster
      const double dx = x[first + i] - query.x(), dy = y[first + i] - query.y(),
                   dz = z[first + i] - query.z();
      leaf.distance_squared[i] = dx * dx + dy * dy + dz * dz;
    }
    return leaf;
  }
};

KdTree::KdTree(std::span<const Vec3> points) : KdTree(points, all_of(points)) {}
KdTree::KdTree(std::span<const Vec3> points, std::vector<std::int32_t> members)
    : impl_(std::make_unique<Impl>(points, std::move(members))) {}
KdTree::KdTree(KdTree&&) noexcept = default;
KdTree& KdTree::operator=(KdTree&&) noexcept = default;
KdTree::~KdTree() = default;

std::size_t KdTree::size() const { return impl_->size(); }

bool KdTree::contains(std::int32_t point) const { return std::ranges::binary_search(impl_->members, point); }

void KdTree::nearest(const Vec3& query, std::size_t k, std::vector<Neighbour>& found) const {
  k = std::min(k, size());
  if (k > kMany) {
    ManyNearestSet set(found, k);
    impl_->search(set, query);
    set.finish();
  } else {
    NearestSet set(found, k);
    if (k > 0) impl_->search(set, query);
  }
  if (found.size() < k) throw ShapeError("squared distances between points overflow: scale the coordinates");
}

std::int32_t KdTree::nearest(const Vec3& query) const {
  CHECK_GT(size(), 0U);
  std::vector<Neighbour> found;
  found.reserve(1);
  nearest(query, 1, found);
  return found.front().index;
}

NearestPoints KdTree::nearest_of_each(std::span<const Vec3> queries, std::size_t k) const {
  NearestPoints all(queries.size(), std::min(k, size()));
  parallel_ranges(queries.size(), kPointGrain, [&](std::size_t first, std::size_t last) {
    std::vector<Neighbour> found;
    for (std::size_t i = first; i < last; ++i) {
      nearest(queries[i], k, found);
      std::ranges::copy(found, all.of(i).begin());
    }
  });
  return all;
}

void KdTree::within(const Vec3& query, double radius, std::vector<Neighbour>& found) const {
  within_unordered(query, radius, found);
  std::ranges::sort(found, closer);
}

void KdTree::within_unordered(const Vec3& query, double radius, std::vector<Neighbour>& found) const {
  WithinSet set(found, radius * radius);
  impl_->search(set, query);
  set.finish();
}

void KdTree::pairs_within(double radius, const VisitPairs& visit) const {
  impl_->pairs_within(radius, visit);
}

std::optional<std::array<std::size_t, 2>> KdTree::count_pairs_within(double small, double large,
                                                                     std::size_t most) const {
  return impl_->count_pairs_within(small, large, most);
}

// Neighbours in the tree's order are close in space.
std::vector<std::int32_t> KdTree::even_sample(std::size_t count) const {
  count = std::min(count, size());
  std::vector<std::int32_t> sample;
  sample.reserve(count);
  for (std::size_t i = 0; i < count; ++i)
    sample.push_back(impl_->tree.order[(2 * i + 1) * size() / (2 * count)]);
  std::ranges::sort(sample);
  return sample;
}

}  // namespace salbench
