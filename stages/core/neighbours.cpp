// SPDX-License-Identifier: GPL-3.0-or-later
// nanoflann keeps the first of equally distant candidates that it meets. To be independent of the tree's
// layout, a k-search also takes candidates at exactly the k-th distance and lets the index decide.
#include "stages/core/neighbours.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <nanoflann.hpp>

#include "stages/core/check.h"

namespace salbench {
namespace {

struct Adaptor {
  std::span<const Vec3> points;
  std::vector<std::int32_t> members;
  bool all_points;

  std::size_t kdtree_get_point_count() const { return all_points ? points.size() : members.size(); }
  std::int32_t index_of(std::size_t i) const {
    return all_points ? static_cast<std::int32_t>(i) : members[i];
  }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return points[static_cast<std::size_t>(index_of(i))][static_cast<Eigen::Index>(axis)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Adaptor>, Adaptor, 3,
                                                 std::uint32_t>;

bool closer(const Neighbour& a, const Neighbour& b) {
  return a.distance_squared != b.distance_squared ? a.distance_squared < b.distance_squared
                                                  : a.index < b.index;
}

constexpr std::size_t kMany = 64;

// Raises the limit by more than rounding, even if it is 0.
double widened(double limit) { return limit * (1 + 1e-12) + std::numeric_limits<double>::min(); }

// The result sets below are those of nanoflann.

// Keeps the k best by (distance, index) in a sorted array.
class NearestSet {
 public:
  NearestSet(const Adaptor& adaptor, std::vector<Neighbour>& best, std::size_t k)
      : adaptor_(adaptor), best_(best), k_(k) {
    best_.clear();
  }
  bool full() const { return best_.size() == k_; }
  std::size_t size() const { return best_.size(); }
  double worstDist() const {
    // Slightly above the k-th distance, so that the tree still offers candidates exactly there, despite the
    // rounding of its own bounds, and the index can decide between them.
    return full() ? widened(best_.back().distance_squared) : std::numeric_limits<double>::max();
  }
  bool addPoint(double distance_squared, std::uint32_t index) {
    const Neighbour candidate{adaptor_.index_of(index), distance_squared};
    if (full()) {
      if (!closer(candidate, best_.back())) return true;
      best_.pop_back();
    }
    best_.insert(std::upper_bound(best_.begin(), best_.end(), candidate, closer), candidate);
    return true;
  }

 private:
  const Adaptor& adaptor_;
  std::vector<Neighbour>& best_;
  std::size_t k_;
};

// The same where k is large, and inserting into a sorted array would be most of the time: keeps up to 2 k
// candidates, and when there are so many throws away the worse half.
class ManyNearestSet {
 public:
  ManyNearestSet(const Adaptor& adaptor, std::vector<Neighbour>& best, std::size_t k)
      : adaptor_(adaptor), best_(best), k_(k) {
    best_.clear();
    best_.reserve(2 * k);
  }
  bool full() const { return best_.size() >= k_; }
  std::size_t size() const { return best_.size(); }
  double worstDist() const { return widened(limit_); }
  bool addPoint(double distance_squared, std::uint32_t index) {
    if (distance_squared > limit_) return true;
    best_.push_back({adaptor_.index_of(index), distance_squared});
    if (best_.size() == 2 * k_) keep_the_best();
    return true;
  }
  void finish() {
    if (best_.size() > k_) keep_the_best();
    std::sort(best_.begin(), best_.end(), closer);
  }

 private:
  void keep_the_best() {
    const auto last = best_.begin() + static_cast<std::ptrdiff_t>(k_ - 1);
    std::nth_element(best_.begin(), last, best_.end(), closer);
    limit_ = last->distance_squared;
    best_.resize(k_);
  }

  const Adaptor& adaptor_;
  std::vector<Neighbour>& best_;
  std::size_t k_;
  double limit_ = std::numeric_limits<double>::max() / 2;  // of the k-th so far; can be widened
};

class WithinSet {
 public:
  WithinSet(const Adaptor& adaptor, std::vector<Neighbour>& found, double radius_squared)
      : adaptor_(adaptor), found_(found), radius_squared_(radius_squared) {
    found_.clear();
  }
  bool full() const { return true; }
  std::size_t size() const { return found_.size(); }
  double worstDist() const { return widened(radius_squared_); }
  bool addPoint(double distance_squared, std::uint32_t index) {
    if (distance_squared <= radius_squared_) found_.push_back({adaptor_.index_of(index), distance_squared});
    return true;
  }

 private:
  const Adaptor& adaptor_;
  std::vector<Neighbour>& found_;
  double radius_squared_;
};

class WithinCount {
 public:
  explicit WithinCount(double radius_squared) : radius_squared_(radius_squared) {}
  bool full() const { return true; }
  std::size_t size() const { return count_; }
  double worstDist() const { return widened(radius_squared_); }
  bool addPoint(double distance_squared, std::uint32_t) {
    count_ += distance_squared <= radius_squared_;
    return true;
  }

 private:
  double radius_squared_;
  std::size_t count_ = 0;
};

}  // namespace

struct KdTree::Impl {
  Adaptor adaptor;
  Tree tree;
  explicit Impl(Adaptor of)
      : adaptor(std::move(of)), tree(3, adaptor, nanoflann::KDTreeSingleIndexAdaptorParams(12)) {}
  std::size_t size() const { return adaptor.kdtree_get_point_count(); }
  template <class Set>
  void search(Set& set, const Vec3& query) const {
    if (size() > 0) tree.findNeighbors(set, query.data(), nanoflann::SearchParams());
  }
};

KdTree::KdTree(std::span<const Vec3> points) : impl_(std::make_unique<Impl>(Adaptor{points, {}, true})) {}
KdTree::KdTree(std::span<const Vec3> points, std::vector<std::int32_t> members)
    : impl_(std::make_unique<Impl>(Adaptor{points, std::move(members), false})) {}
KdTree::KdTree(KdTree&&) noexcept = default;
KdTree& KdTree::operator=(KdTree&&) noexcept = default;
KdTree::~KdTree() = default;

std::size_t KdTree::size() const { return impl_->size(); }

void KdTree::nearest(const Vec3& query, std::size_t k, std::vector<Neighbour>& found) const {
  k = std::min(k, size());
  if (k > kMany) {
    ManyNearestSet set(impl_->adaptor, found, k);
    impl_->search(set, query);
    set.finish();
  } else {
    NearestSet set(impl_->adaptor, found, k);
    if (k > 0) impl_->search(set, query);
  }
}

std::int32_t KdTree::nearest(const Vec3& query) const {
  CHECK_GT(size(), 0U);
  std::vector<Neighbour> found;
  found.reserve(1);
  nearest(query, 1, found);
  return found.front().index;
}

void KdTree::within(const Vec3& query, double radius, std::vector<Neighbour>& found) const {
  within_unordered(query, radius, found);
  std::sort(found.begin(), found.end(), closer);
}

std::size_t KdTree::count_within(const Vec3& query, double radius) const {
  WithinCount set(radius * radius);
  impl_->search(set, query);
  return set.size();
}

void KdTree::within_unordered(const Vec3& query, double radius, std::vector<Neighbour>& found) const {
  WithinSet set(impl_->adaptor, found, radius * radius);
  impl_->search(set, query);
}

// Points beside each other in the tree's order are near each other in space.
std::vector<std::int32_t> KdTree::even_sample(std::size_t count) const {
  count = std::min(count, size());
  std::vector<std::int32_t> sample;
  sample.reserve(count);
  for (std::size_t i = 0; i < count; ++i)
    sample.push_back(impl_->adaptor.index_of(impl_->tree.vAcc[(2 * i + 1) * size() / (2 * count)]));
  std::sort(sample.begin(), sample.end());
  return sample;
}

}  // namespace salbench
