// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <numbers>
#include <vector>

#include <benchmark/benchmark.h>
#include <flann/algorithms/dist.h>
#include <pcl/console/print.h>
#include <pcl/features/fpfh.h>
#include <pcl/features/normal_3d.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/surface/gp3.h>

#include "stages/core/mesh_ops.h"
#include "stages/core/support.h"
#include "tests/perf/peers.h"

namespace salbench::peers {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;
using NormalCloud = pcl::PointCloud<pcl::Normal>;
using OrientedCloud = pcl::PointCloud<pcl::PointNormal>;

Cloud::Ptr cloud_of(Points points) {
  auto cloud = pcl::make_shared<Cloud>();
  for (const Vec3& p : points) {
    pcl::PointXYZ point;
    point.getVector3fMap() = p.cast<float>();
    cloud->push_back(point);
  }
  return cloud;
}

NormalCloud::Ptr cloud_of_normals(const Normals& normals) {
  auto cloud = pcl::make_shared<NormalCloud>();
  for (const Vec3& n : normals) {
    pcl::Normal normal;
    normal.getNormalVector3fMap() = n.cast<float>();
    cloud->push_back(normal);
  }
  return cloud;
}

// In units of the median spacing, as the limits of the triangulation are.
OrientedCloud::Ptr cloud_in_spacings(Points points, const Normals& normals) {
  const double spacing = median_spacing(KdTree(points).nearest_of_each(points, 2));
  const Vec3 centre = centroid(points);
  auto cloud = pcl::make_shared<OrientedCloud>();
  for (std::size_t i = 0; i < points.size(); ++i) {
    pcl::PointNormal p;
    p.getVector3fMap() = ((points[i] - centre) / spacing).cast<float>();
    p.getNormalVector3fMap() = normals[i].cast<float>();
    cloud->push_back(p);
  }
  return cloud;
}

}  // namespace

// Without a search method PCL makes one itself, which does not sort what lies within a radius.

Work pcl_fpfh(const Shape& shape, const Support& support) {
  return [points = cloud_of(shape.mesh.vertices), normals = cloud_of_normals(shape.normals), support] {
    pcl::FPFHEstimation<pcl::PointXYZ, pcl::Normal, pcl::FPFHSignature33> estimation;
    estimation.setInputCloud(points);
    estimation.setInputNormals(normals);
    if (support.neighbours > 0)
      estimation.setKSearch(support.neighbours);
    else
      estimation.setRadiusSearch(support.radius);
    pcl::PointCloud<pcl::FPFHSignature33> histograms;
    estimation.compute(histograms);
    benchmark::DoNotOptimize(histograms);
    return histograms.size();
  };
}

Work pcl_normals(const Shape& shape, std::int32_t neighbours) {
  const Eigen::Vector3f camera = shape.scan->camera.cast<float>();
  return [points = cloud_of(shape.scan->points), camera, neighbours] {
    pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
    estimation.setInputCloud(points);
    estimation.setKSearch(neighbours);
    estimation.setViewPoint(camera.x(), camera.y(), camera.z());
    NormalCloud normals;
    estimation.compute(normals);
    benchmark::DoNotOptimize(normals);
    return normals.size();
  };
}

Work pcl_surface(const Shape& shape, const SurfaceOptions& options) {
  pcl::console::setVerbosityLevel(pcl::console::L_ERROR);  // else a line per point with too few neighbours
  return [cloud = cloud_in_spacings(shape.scan->points, shape.scan_normals), options] {
    constexpr double kRadiansPerDegree = std::numbers::pi / 180;
    pcl::GreedyProjectionTriangulation<pcl::PointNormal> triangulation;
    triangulation.setMu(options.reach);
    triangulation.setSearchRadius(options.longest_edge);
    triangulation.setMaximumNearestNeighbors(options.neighbours);
    triangulation.setMaximumSurfaceAngle(options.max_normal_angle_degrees * kRadiansPerDegree);
    triangulation.setMinimumAngle(options.smallest_angle * kRadiansPerDegree);
    triangulation.setMaximumAngle(options.largest_angle * kRadiansPerDegree);
    triangulation.setNormalConsistency(true);
    triangulation.setSearchMethod(pcl::make_shared<pcl::search::KdTree<pcl::PointNormal>>());
    triangulation.setInputCloud(cloud);
    std::vector<pcl::Vertices> polygons;
    triangulation.reconstruct(polygons);
    benchmark::DoNotOptimize(polygons);
    return polygons.size();
  };
}

Work flann_chi_squares(const Shape& shape) {
  return
      [&descriptors = shape.descriptors, distances = std::vector<float>(shape.descriptors.size())]() mutable {
        const flann::ChiSquareDistance<float> chi_square;
        for (std::size_t query = 0; query < kQueries; ++query) {
          const auto of = descriptors.row(query * descriptors.size() / kQueries);
          for (std::size_t i = 0; i < descriptors.size(); ++i)
            distances[i] = chi_square(of.data(), descriptors.row(i).data(), kFpfhBins);
          benchmark::DoNotOptimize(distances.data());
          benchmark::ClobberMemory();
        }
        return kQueries * descriptors.size();
      };
}

}  // namespace salbench::peers
