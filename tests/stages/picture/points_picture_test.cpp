// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of scans and point clouds: their partial mesh, and squares in its holes. Camera and light are
// those of meshes (picture_test.cpp).

#include "stages/picture/picture.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

const RandomSource kRandom{2016, "1_3"};

PointCloud cloud_of(const Mesh& mesh) { return {.points = mesh.vertices}; }

Picture picture_of(const PointCloud& cloud, const Faces& surface, const PictureOptions& options) {
  return picture_of_cloud(cloud, cloud.points, surface, options,
                          kRandom);  // a sphere's points are its normals
}

// Point of the mesh that a pixel shows: the corner with the largest weight in the visible face.
std::int32_t nearest_corner(const Picture& picture, const Mesh& mesh, std::size_t pixel) {
  const float* weights = &picture.weights[3 * pixel];
  return mesh.faces[index(picture.primitive[pixel])]
                   [static_cast<std::size_t>(std::max_element(weights, weights + 3) - weights)];
}

TEST(PictureOfPoints, IsThatOfTheirPartialMeshWithPointsAsPrimitives) {
  const Mesh mesh = shapes::sphere(4);
  const PictureOptions options{.size = 120};
  const Picture of_mesh = picture_of_mesh(mesh, options, kRandom);
  const Picture of_cloud = picture_of(cloud_of(mesh), mesh.faces, options);
  EXPECT_EQ(of_cloud.view_projection, of_mesh.view_projection);
  std::size_t same = 0, seen = 0;
  for (std::size_t pixel = 0; pixel < of_mesh.pixels(); ++pixel) {
    if (of_mesh.primitive[pixel] < 0) continue;
    ++seen;
    ASSERT_EQ(of_cloud.weights[3 * pixel], 1);
    ASSERT_EQ(of_cloud.weights[3 * pixel + 1] + of_cloud.weights[3 * pixel + 2], 0);
    if (of_cloud.depth[pixel] != of_mesh.depth[pixel]) continue;
    ASSERT_EQ(of_cloud.primitive[pixel], nearest_corner(of_mesh, mesh, pixel));
    same += of_cloud.shade[pixel] == of_mesh.shade[pixel] ? 1U : 0U;
  }
  EXPECT_GT(same, 0.95 * static_cast<double>(seen)) << "but along the outline, where squares look out";
}

// Points anywhere on the unit sphere, denser on one half: the sphere fills 92 % of the width.
TEST(PictureOfPoints, HaveHardlyAnyHolesWithoutAnyFaceAndHideWhatIsBehind) {
  PointCloud cloud{.points = shapes::random_normals(4000, 5)};
  for (const Vec3& p : shapes::random_normals(4000, 6))
    if (p.x() > 0) cloud.points.push_back(p);
  const Picture picture = picture_of(cloud, {}, {.size = 200});
  const auto& m = picture.view_projection;
  std::size_t inside = 0, open = 0;
  for (int row = 0; row < 200; ++row)
    for (int column = 0; column < 200; ++column) {
      if (std::hypot(row + 0.5 - 100, column + 0.5 - 100) > 80) continue;
      ++inside;
      const std::int32_t point = picture.primitive[index(row * 200 + column)];
      const Vec3 p = point < 0 ? Vec3::Zero() : cloud.points[index(point)];
      // Background, or the far half; m[15] is the depth of the centre.
      open += m[12] * p.x() + m[13] * p.y() + m[14] * p.z() >= 0 ? 1U : 0U;
    }
  EXPECT_LT(static_cast<double>(open), 0.03 * static_cast<double>(inside));
}

TEST(PictureOfPoints, ShowTheBackOfASurfaceAsWell) {
  const PointCloud cloud{.points = shapes::random_normals(2000, 5)};
  Normals inwards = cloud.points;
  for (Vec3& normal : inwards) normal = -normal;
  EXPECT_EQ(picture_of_cloud(cloud, inwards, {}, {.size = 60}, kRandom).shade,
            picture_of(cloud, {}, {.size = 60}).shade);
}

TEST(PictureOfCloud, IsTakenFromNearAViewpointOutsideOfTheCloudAlone) {
  const Mesh mesh = shapes::sphere(3);
  PointCloud cloud = cloud_of(mesh);
  const PictureOptions options{.size = 60, .scan_turn = 0};
  const auto camera = [&] { return picture_of(cloud, mesh.faces, options).view_projection; };
  const auto without = camera();
  cloud.viewpoint = Vec3(0.2, 0, 0);
  EXPECT_EQ(camera(), without);
  cloud.viewpoint = Vec3(0, 0, -7);
  EXPECT_GT(camera()[14], 0.99);  // depth grows along z
}

TEST(PictureOfScan, IsTakenFromNearItsOwnCamera) {
  const Mesh mesh = shapes::sphere(3);
  const Scan scan{mesh.vertices, Vec3(0, 0, -7)};
  const Picture picture =
      picture_of_scan(scan, mesh.vertices, mesh.faces, mesh, {.size = 60, .scan_turn = 0}, kRandom);
  EXPECT_GT(picture.view_projection[14], 0.99);
}

TEST(PictureOfPoints, RefusesWhatCannotBeSeen) {
  const auto taking = [](const PointCloud& cloud) { return [=] { picture_of(cloud, {}, {}); }; };
  const auto scanned = [](const Scan& scan) {
    return [=] { picture_of_scan(scan, scan.points, {}, shapes::sphere(1), {}, kRandom); };
  };
  EXPECT_THAT(taking({}), Refuses("the point cloud is empty"));
  EXPECT_THAT(scanned({}), Refuses("the scan is empty"));
  PointCloud cloud = cloud_of(shapes::sphere(2));
  cloud.points[3].x() = kNan;
  EXPECT_THAT(taking(cloud), Refuses("finite"));
  EXPECT_THAT(scanned({cloud.points, Vec3(3, 0, 0)}), Refuses("finite"));
  cloud.points.resize(1);
  EXPECT_THAT(taking(cloud), Refuses("in one place"));
}

}  // namespace
}  // namespace salbench
