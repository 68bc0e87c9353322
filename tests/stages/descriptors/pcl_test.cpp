// SPDX-License-Identifier: GPL-3.0-or-later
// Comparison with PCL's pair features and histograms, where the definitions coincide.

#include <pcl/features/fpfh.h>
#include <pcl/features/impl/fpfh.hpp>
#include <pcl/features/pfh_tools.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>

#include "stages/descriptors/fpfh.h"
#include "stages/descriptors/pair_features.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

Eigen::Vector4f in_pcl(const Vec3& v) { return {float(v.x()), float(v.y()), float(v.z()), 0.0F}; }

TEST(PairFeatures, EqualThoseOfPcl) {
  const auto points = shapes::random_cloud(400, 41);
  const auto normals = shapes::random_normals(400, 42);
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    float theta = 0, alpha = 0, phi = 0, distance = 0;
    pcl::computePairFeatures(in_pcl(points[i]), in_pcl(normals[i]), in_pcl(points[i + 1]),
                             in_pcl(normals[i + 1]), theta, alpha, phi, distance);
    const DarbouxTriple pair = pair_features(points[i], normals[i], points[i + 1], normals[i + 1], true);
    EXPECT_NEAR(pair.theta, theta, 2e-5) << i;
    EXPECT_NEAR(pair.alpha, alpha, 2e-5) << i;
    EXPECT_NEAR(pair.phi, phi, 2e-5) << i;
  }
}

// PCL keeps the signs: folding its histograms about the middle bin gives those of the absolute values.
std::array<float, kFpfhBins> folded(const pcl::FPFHSignature33& signature) {
  std::array<float, kFpfhBins> result{};
  for (std::size_t block = 0; block < 33; block += 11)
    for (std::size_t b = 0; b < 11; ++b)
      result[block + std::max(b, 10 - b)] += signature.histogram[block + b];
  return result;
}

TEST(FpfhHistogram, EqualsThatOfPclFolded) {
  const auto points = shapes::random_cloud(300, 43);
  const auto normals = shapes::random_normals(300, 44);
  const auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  const auto cloud_normals = std::make_shared<pcl::PointCloud<pcl::Normal>>();
  for (const Vec3& p : points) cloud->emplace_back(float(p.x()), float(p.y()), float(p.z()));
  for (const Vec3& n : normals) cloud_normals->emplace_back(float(n.x()), float(n.y()), float(n.z()));
  pcl::FPFHEstimation<pcl::PointXYZ, pcl::Normal, pcl::FPFHSignature33> estimation;
  estimation.setInputCloud(cloud);
  estimation.setInputNormals(cloud_normals);
  estimation.setSearchMethod(std::make_shared<pcl::search::KdTree<pcl::PointXYZ>>());
  estimation.setKSearch(9);
  pcl::PointCloud<pcl::FPFHSignature33> expected;
  estimation.compute(expected);

  const Descriptors d = fpfh(points, normals, KdTree(points), {9, 0}, FpfhWeighting::published);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto row = folded(expected[i]);
    for (std::size_t b = 0; b < kFpfhBins; ++b)
      ASSERT_NEAR(d.row(i)[b], row[b], 1e-3) << "point " << i << ", bin " << b;
  }
}

}  // namespace
}  // namespace salbench
