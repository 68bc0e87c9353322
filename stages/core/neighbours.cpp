// nanoflann keeps the first of equally distant candidates that it meets. To be independent of the tree's
// layout, a k-search also takes candidates at exactly the k-th distance and lets the index decide.
#include "stages/core/neighbours.h"

#include <algorithm>
#include <limits>

#include <nanoflann.hpp>

#include "stages/core/check.h"

namespace salbench {
namespace {

struct Adaptor {
  std::span<const Vec3> points;
  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return points[i][static_cast<Eigen::Index>(axis)];
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

// Raises the limit by more than rounding, even if it is 0.
double widened(double limit) { return limit * (1 + 1e-12) + std::numeric_limits<double>::min(); }

// Result set of nanoflann: keeps the k best by (distance, index) in a sorted array.
class NearestSet {
 public:
  NearestSet(std::vector<Neighbour>& best, std::size_t k) : best_(best), k_(k) { best_.clear(); }
  bool full() const { return best_.size() == k_; }
  std::size_t size() const { return best_.size(); }
  double worstDist() const {
    // Slightly above the k-th distance, so that the tree still offers candidates exactly there, despite the
    // rounding of its own bounds, and the index can decide between them.
    return full() ? widened(best_.back().distance_squared) : std::numeric_limits<double>::max();
  }
  bool addPoint(double distance_squared, std::uint32_t index) {
    const Neighbour candidate{static_cast<std::int32_t>(index), distance_squared};
    if (full()) {
      if (!closer(candidate, best_.back())) return true;
      best_.pop_back();
    }
    best_.insert(std::upper_bound(best_.begin(), best_.end(), candidate, closer), candidate);
    return true;
  }

 private:
  std::vector<Neighbour>& best_;
  std::size_t k_;
};

class WithinSet {
 public:
  WithinSet(std::vector<Neighbour>& found, double radius_squared)
      : found_(found), radius_squared_(radius_squared) {
    found_.clear();
  }
  bool full() const { return true; }
  std::size_t size() const { return found_.size(); }
  double worstDist() const { return widened(radius_squared_); }
  bool addPoint(double distance_squared, std::uint32_t index) {
    if (distance_squared <= radius_squared_)
      found_.push_back({static_cast<std::int32_t>(index), distance_squared});
    return true;
  }

 private:
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
  explicit Impl(std::span<const Vec3> points)
      : adaptor{points}, tree(3, adaptor, nanoflann::KDTreeSingleIndexAdaptorParams(12)) {}
};

KdTree::KdTree(std::span<const Vec3> points) : impl_(std::make_unique<Impl>(points)) {}
KdTree::KdTree(KdTree&&) noexcept = default;
KdTree& KdTree::operator=(KdTree&&) noexcept = default;
KdTree::~KdTree() = default;

std::size_t KdTree::size() const { return impl_->adaptor.points.size(); }

void KdTree::nearest(const Vec3& query, std::size_t k, std::vector<Neighbour>& found) const {
  NearestSet set(found, std::min(k, size()));
  if (k == 0 || size() == 0) return;
  impl_->tree.findNeighbors(set, query.data(), nanoflann::SearchParams());
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
  if (size() > 0) impl_->tree.findNeighbors(set, query.data(), nanoflann::SearchParams());
  return set.size();
}

void KdTree::within_unordered(const Vec3& query, double radius, std::vector<Neighbour>& found) const {
  WithinSet set(found, radius * radius);
  if (size() == 0) return;
  impl_->tree.findNeighbors(set, query.data(), nanoflann::SearchParams());
}

}  // namespace salbench
