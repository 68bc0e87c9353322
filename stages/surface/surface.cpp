// SPDX-License-Identifier: GPL-3.0-or-later
// PCL's triangulation works in float, and its limits are lengths. The points are passed relative to their
// mean and in units of the median spacing, so that position and unit of the mesh have no effect.
//
// Declared before any header: PCL's std::atan2 of floats must resolve to atan2f.h's function, under its name.
extern "C" float atan2f(float y, float x) noexcept __asm__("salbench_atan2f");

#include "stages/surface/surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

// PCL's triangulation is compiled here, so that it uses our atan2f and rounds like the rest: Debian's build
// for arm64 fuses products and sums.
#define PCL_NO_PRECOMPILE
#include <flann/algorithms/dist.h>
#include <flann/algorithms/kdtree_single_index.h>
#include <pcl/console/print.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/search.h>
#include <pcl/surface/gp3.h>

#include "stages/core/check.h"
#include "stages/geometry/mesh_ops.h"
#include "stages/geometry/neighbours.h"
#include "stages/geometry/support.h"

namespace salbench {
namespace {

using Cloud = pcl::PointCloud<pcl::PointNormal>;

// Otherwise PCL writes a line to standard error for each point with too few neighbours, which every scan has.
void silence_pcl() {
  static const bool silenced = [] {
    pcl::console::setVerbosityLevel(pcl::console::L_ERROR);
    return true;
  }();
  static_cast<void>(silenced);
}

Cloud::Ptr cloud_in_spacings(Points points, const Normals& normals, double spacing) {
  const Vec3 centre = centroid(points);
  auto cloud = pcl::make_shared<Cloud>();
  cloud->reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    pcl::PointNormal p;
    p.getVector3fMap() = ((points[i] - centre) / spacing).cast<float>();
    p.getNormalVector3fMap() = normals[i].cast<float>();
    cloud->push_back(p);
  }
  return cloud;
}

// The tree of pcl::search::KdTree, whose order of equally distant points determines where faces begin. PCL's
// own class allocates memory and starts a team of threads for each query. Searches the constructor's cloud.
class CloudSearch final : public pcl::search::Search<pcl::PointNormal> {
 public:
  using Distances = std::vector<float>;
  using Search::nearestKSearch;
  using Search::radiusSearch;

  explicit CloudSearch(const Cloud& cloud) : places_(places_of(cloud)) { tree_.buildIndex(); }

  int nearestKSearch(const pcl::PointNormal& query, int k, pcl::Indices& found,
                     Distances& distances_squared) const override {
    const auto count = static_cast<std::size_t>(k);
    CHECK_LE(count, input_->size());
    if (!nearest_ || found_.size() != count) nearest_.emplace(count);
    nearest_->clear();
    tree_.findNeighbors(*nearest_, query.data, flann::SearchParams(flann::FLANN_CHECKS_UNLIMITED));
    // FLANN finds fewer than k points if squared distances overflow, and PCL reads all k: the rest are set to
    // the first point, too far away to be connected.
    found_.assign(count, 0);
    distances_squared.assign(count, std::numeric_limits<float>::max());
    nearest_->copy(found_.data(), distances_squared.data(), nearest_->size());
    found.assign(found_.begin(), found_.end());
    return k;
  }

  int radiusSearch(const pcl::PointNormal&, double, pcl::Indices&, Distances&, unsigned) const override {
    throw std::logic_error("the triangulation searches by number only");
  }

 private:
  static constexpr int kPclLeaf = 15;  // points at most

  static std::vector<float> places_of(const Cloud& cloud) {
    std::vector<float> places;
    places.reserve(3 * cloud.size());
    for (const pcl::PointNormal& p : cloud) places.insert(places.end(), {p.x, p.y, p.z});
    return places;
  }

  std::vector<float> places_;  // n x 3
  flann::KDTreeSingleIndex<flann::L2_Simple<float>> tree_{
      flann::Matrix<float>(places_.data(), places_.size() / 3, 3), flann::KDTreeSingleIndexParams(kPclLeaf)};
  mutable std::optional<flann::KNNSimpleResultSet<float>> nearest_;  // working memory, as the following
  mutable std::vector<std::size_t> found_;
};

// Orients the face towards the normals of its corners, whatever order PCL gave them.
Triangle oriented(Triangle face, Points points, const Normals& normals) {
  const auto at = [&face](std::span<const Vec3> of, std::size_t corner) -> const Vec3& {
    return of[static_cast<std::size_t>(face[corner])];
  };
  const Vec3 area = (at(points, 1) - at(points, 0)).cross(at(points, 2) - at(points, 0));
  if (area.dot(at(normals, 0) + at(normals, 1) + at(normals, 2)) < 0) std::swap(face[1], face[2]);
  return face;
}

// Edges in the direction in which faces traverse them. A point has a slot for each corner of a face at it.
class PassedEdges {
 public:
  PassedEdges(std::size_t n_points, const Faces& faces) : end_(n_points + 1, 0), to_(3 * faces.size()) {
    for (const Triangle& face : faces)
      for (const std::int32_t v : face) ++end_[static_cast<std::size_t>(v) + 1];
    std::partial_sum(end_.begin(), end_.end(), end_.begin());
    begin_ = end_;
  }
  bool contains(std::int32_t from, std::int32_t to) const {
    const auto at = static_cast<std::size_t>(from);
    return std::find(to_.data() + begin_[at], to_.data() + end_[at], to) != to_.data() + end_[at];
  }
  void insert(std::int32_t from, std::int32_t to) { to_[end_[static_cast<std::size_t>(from)]++] = to; }

 private:
  std::vector<std::size_t> begin_, end_;  // per point
  std::vector<std::int32_t> to_;
};

// PCL's faces overlap in places, and some are duplicates. Keeps the first of several faces that traverse an
// edge in the same direction, so that the faces are oriented consistently.
Faces consistently_oriented(std::size_t n_points, const Faces& faces) {
  PassedEdges passed(n_points, faces);
  Faces kept;
  kept.reserve(faces.size());
  for (const auto& [a, b, c] : faces) {
    if (passed.contains(a, b) || passed.contains(b, c) || passed.contains(c, a)) continue;
    passed.insert(a, b);
    passed.insert(b, c);
    passed.insert(c, a);
    kept.push_back({a, b, c});
  }
  return kept;
}

}  // namespace

Faces partial_mesh(Points points, const Normals& normals, const SurfaceOptions& options) {
  CHECK_EQ(normals.size(), points.size());
  if (points.size() < 3) return {};
  const double spacing = median_spacing(KdTree(points).nearest_of_each(points, 2));
  if (!(spacing > 0)) return {};

  silence_pcl();
  pcl::GreedyProjectionTriangulation<pcl::PointNormal> triangulation;
  triangulation.setMu(options.reach);
  triangulation.setSearchRadius(options.longest_edge);
  triangulation.setMaximumNearestNeighbors(options.neighbours);
  triangulation.setMaximumSurfaceAngle(options.max_normal_angle_degrees * kRadiansPerDegree);
  triangulation.setMinimumAngle(options.smallest_angle * kRadiansPerDegree);
  triangulation.setMaximumAngle(options.largest_angle * kRadiansPerDegree);
  triangulation.setNormalConsistency(true);
  const Cloud::Ptr cloud = cloud_in_spacings(points, normals, spacing);
  triangulation.setSearchMethod(pcl::make_shared<CloudSearch>(*cloud));
  triangulation.setInputCloud(cloud);
  std::vector<pcl::Vertices> polygons;
  triangulation.reconstruct(polygons);

  Faces faces;
  faces.reserve(polygons.size());
  for (const pcl::Vertices& polygon : polygons) {
    const auto& v = polygon.vertices;
    CHECK_EQ(v.size(), 3U);
    faces.push_back(oriented({v[0], v[1], v[2]}, points, normals));
  }
  return consistently_oriented(points.size(), faces);
}

}  // namespace salbench
