// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/descriptors/fpfh.h"

#include "stages/geometry/mesh_ops.h"
#include "stages/geometry/support.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

TEST(Fpfh, StoresTheSupportThatWasUsed) {
  const auto points = shapes::random_cloud(300, 51);
  const auto normals = shapes::random_normals(300, 52);
  FpfhOptions options;
  const Descriptors nearest = fpfh(points, normals, options);
  EXPECT_EQ(nearest.neighbours, 9);
  EXPECT_EQ(nearest.radius, 0);

  options.neighbourhood = FpfhNeighbourhood::radius;
  const Descriptors grown = fpfh(points, normals, options);
  EXPECT_EQ(grown.neighbours, 0);
  EXPECT_EQ(grown.radius, grown_support_radius(points, 0.01).radius);

  options.grown_neighbours = 12;
  EXPECT_EQ(fpfh(points, normals, options).radius,
            grown_support_radius(points, KdTree(points), 0.01, 12).radius);

  options.grow = false;
  options.radius = 0.4;
  const Descriptors fixed = fpfh(points, normals, options);
  EXPECT_EQ(fixed.radius, 0.4 * bounding_radius(points));
  EXPECT_EQ(fixed.values,
            fpfh(points, normals, KdTree(points), {0, fixed.radius}, FpfhWeighting::published).values);
}

TEST(Fpfh, HandsTheWeightingOn) {
  const auto points = shapes::random_cloud(100, 53);
  const auto normals = shapes::random_normals(100, 54);
  FpfhOptions options;
  options.weighting = FpfhWeighting::text;
  EXPECT_EQ(fpfh(points, normals, options).values,
            fpfh(points, normals, KdTree(points), {9, 0}, FpfhWeighting::text).values);
}

TEST(Fpfh, RefusesAShapeWithoutPointsOrWithCoordinatesThatAreNotFinite) {
  EXPECT_THROW(fpfh({}, {}, FpfhOptions{}), InputError);
  for (const double bad : {std::nan(""), kInfinity, 1e200}) {
    auto points = shapes::random_cloud(20, 55);
    points[4].z() = bad;
    EXPECT_THROW(fpfh(points, shapes::random_normals(20, 56), FpfhOptions{}), InputError) << bad;
  }
}

}  // namespace
}  // namespace salbench
