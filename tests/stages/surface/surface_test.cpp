// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/surface/surface.h"

#include "io/shapes/mesh_file.h"
#include "stages/geometry/mesh_ops.h"
#include "stages/normals/normals.h"
#include "stages/scan/scan.h"
#include "tests/support/data.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"
#include "tests/support/threads.h"

namespace salbench {
namespace {

double share_covered(const Scan& scan, const Faces& faces) {
  std::vector<char> covered(scan.points.size(), 0);
  for (const Triangle& face : faces)
    for (const std::int32_t v : face) covered[index(v)] = 1;
  return static_cast<double>(std::count(covered.begin(), covered.end(), 1)) /
         static_cast<double>(covered.size());
}

double longest_edge(const Scan& scan, const Faces& faces) {
  double longest = 0;
  for (const Triangle& face : faces)
    for (std::size_t k = 0; k < 3; ++k)
      longest =
          std::max(longest, (scan.points[index(face[k])] - scan.points[index(face[(k + 1) % 3])]).norm());
  return longest;
}

// Every edge is traversed at most once in each direction, so in at most two faces.
void expect_consistently_oriented(const Faces& faces, std::size_t n_points) {
  std::set<std::pair<std::int32_t, std::int32_t>> passed;
  for (const Triangle& face : faces) {
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_GE(face[k], 0);
      ASSERT_LT(index(face[k]), n_points);
      ASSERT_NE(face[k], face[(k + 1) % 3]);
      EXPECT_TRUE(passed.emplace(face[k], face[(k + 1) % 3]).second)
          << face[k] << " to " << face[(k + 1) % 3];
    }
  }
}

TEST(PartialMesh, OfASphereIsItsVisibleCap) {
  const Mesh mesh = shapes::sphere(5);
  for (const int view : {0, 4, 9}) {
    const Scan scan = simulate_scan(mesh, view);
    const Faces faces = partial_mesh(scan.points, scan_normals(scan));
    expect_consistently_oriented(faces, scan.points.size());
    EXPECT_GT(share_covered(scan, faces), 0.98) << "view " << view;

    // The zone of the cap that the camera sees at less than 60 degrees: 2 pi times its height. Further out
    // the rays' rows diverge.
    const Mesh partial{scan.points, faces};
    double zone = 0, inward = 0;
    for (const Triangle& face : faces) {
      const Vec3 area = face_area_vector(partial, face) / 2;
      const Vec3 radial =
          (scan.points[index(face[0])] + scan.points[index(face[1])] + scan.points[index(face[2])])
              .normalized();
      if (radial.dot(scan.camera.normalized()) < 0.5) continue;
      zone += area.norm();
      if (area.dot(radial) <= 0) inward += area.norm();  // slivers
    }
    EXPECT_NEAR(zone, std::numbers::pi, 0.01) << "view " << view;
    EXPECT_LT(inward, 1e-4 * zone) << "view " << view;
  }
}

TEST(PartialMesh, LeavesDepthJumpsOpen) {
  Mesh mesh = shapes::grid(4);
  Mesh front = shapes::grid(4);
  for (Vec3& v : mesh.vertices) v = 4 * v + Vec3(-2, -2, -1);
  for (Vec3& v : front.vertices) v = v + Vec3(-0.5, -0.5, 1);
  const Scan scan = simulate_scan(shapes::joined(mesh, front), 1);
  const Faces faces = partial_mesh(scan.points, scan_normals(scan));
  EXPECT_GT(share_covered(scan, faces), 0.98);
  for (const Triangle& face : faces) {
    for (const std::int32_t v : face)
      ASSERT_LT(std::abs(scan.points[index(v)].z() - scan.points[index(face[0])].z()), 1)
          << "a face spans front and back";
  }
}

TEST(PartialMesh, FillsAGridWithTwoFacesACell) {
  const Scan scan{shapes::grid(20).vertices, {0, 0, 5}};
  const Faces faces = partial_mesh(scan.points, Normals(scan.points.size(), Vec3::UnitZ()));
  expect_consistently_oriented(faces, scan.points.size());
  EXPECT_GT(share_covered(scan, faces), 0.95);
  EXPECT_NEAR(surface_area({scan.points, faces}), 1, 0.05);
}

TEST(PartialMesh, DependsNeitherOnTheUnitNorOnThePlace) {
  const Scan scan = simulate_scan(shapes::bumpy_sphere(4), 7);
  const Normals normals = scan_normals(scan);
  Scan moved = scan;
  for (Vec3& p : moved.points) p = 1e-5 * p + Vec3(3, -8, 1);  // in float, the shape would be lost
  const Faces faces = partial_mesh(scan.points, normals), after = partial_mesh(moved.points, normals);
  const auto count = static_cast<double>(faces.size());
  const double area = surface_area({scan.points, faces});
  EXPECT_NEAR(static_cast<double>(after.size()), count, 0.01 * count);
  // Rounding decides between faces of nearly equal angles, differently on arm64.
  EXPECT_NEAR(surface_area({moved.points, after}) * 1e10, area, 0.01 * area);
}

TEST(PartialMesh, EdgesKeepToTheReach) {
  const Scan scan = simulate_scan(shapes::bumpy_sphere(4), 2);
  const Normals normals = scan_normals(scan);
  const SurfaceOptions wide{.reach = 6, .longest_edge = 6}, tight{.reach = 6, .longest_edge = 1.5};
  const double step = std::tan(0.125 * std::numbers::pi / 180) * (scan.camera.norm() - 1.2);
  EXPECT_GT(longest_edge(scan, partial_mesh(scan.points, normals, wide)), 3 * step);
  EXPECT_LT(longest_edge(scan, partial_mesh(scan.points, normals, tight)), 2.5 * step);
}

TEST(PartialMesh, TooFewPointsHaveNoFaces) {
  for (const std::size_t n : {0U, 1U, 2U})
    EXPECT_TRUE(partial_mesh(shapes::random_cloud(n, 1), Normals(n, Vec3::UnitZ())).empty());
  EXPECT_TRUE(partial_mesh(std::vector<Vec3>(8, Vec3(1, 1, 1)), Normals(8, Vec3::UnitZ())).empty());
}

TEST(PartialMesh, ThreePointsAreAFaceTowardsTheirNormals) {
  const Scan scan{{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}}, {0, 0, 9}};
  const Faces faces = partial_mesh(scan.points, Normals(3, Vec3::UnitZ()));
  ASSERT_EQ(faces.size(), 1U);
  EXPECT_GT(face_area_vector({scan.points, faces}, faces[0]).z(), 0);
}

// In single precision, squared distances overflow from 1e20 on and coordinates from 1e39 on.
TEST(PartialMesh, PointsAreNotConnectedWithOthersFarAway) {
  for (const double distance : {1e15, 1e25, 1e45}) {
    std::vector<Vec3> points;
    for (int i = 0; i < 100; ++i) points.emplace_back(i / 10, i % 10, 0);
    const Normals normals(102, Vec3::UnitZ());
    points.emplace_back(distance, 0, 0);
    points.emplace_back(-distance, 0, 0);  // the mean stays near the others
    const Faces faces = partial_mesh(points, normals, {});
    EXPECT_GT(faces.size(), 100U);
    expect_consistently_oriented(faces, points.size());
    for (const Triangle& face : faces)
      for (const std::int32_t v : face) EXPECT_LT(v, 100);
  }
}

TEST(PartialMesh, DoesNotDependOnOtherThreads) {
  const Scan scan = simulate_scan(shapes::bumpy_sphere(3), 6);
  const Normals normals = scan_normals(scan);
  EXPECT_GT(same_in_threads_at_once([&] { return partial_mesh(scan.points, normals); }).size(),
            scan.points.size());
}

TEST(PartialMesh, CoversRealScans) {
  const auto data = real_data();
  if (!data) GTEST_SKIP() << kNoRealData;
  for (const int number : {9, 52, 124, 209, 260, 353}) {
    const auto path = *data / "SchellingData" / "Meshes" / (std::to_string(number) + ".off");
    if (!std::filesystem::exists(path)) continue;
    const Scan scan = simulate_scan(read_mesh(path), number % kViews);
    const Faces faces = partial_mesh(scan.points, scan_normals(scan));
    EXPECT_GT(share_covered(scan, faces), 0.97) << number;
    expect_consistently_oriented(faces, scan.points.size());
  }
}

}  // namespace
}  // namespace salbench
