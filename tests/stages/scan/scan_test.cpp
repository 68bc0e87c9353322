// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/scan/scan.h"

#include "stages/geometry/mesh_ops.h"
#include "stages/geometry/neighbours.h"
#include "tests/support/rays.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"
#include "tests/support/threads.h"

namespace salbench {
namespace {

constexpr double kC = 0.85065, kD = 0.52573;
const Vec3 kViewDirections[kViews] = {{0, kD, -kC},  {0, kD, kC},  {0, -kD, kC},  {-kD, kC, 0},
                                      {-kD, -kC, 0}, {kD, kC, 0},  {kD, -kC, 0},  {0, -kD, -kC},
                                      {kC, 0, kD},   {-kC, 0, kD}, {-kC, 0, -kD}, {kC, 0, -kD}};

Mesh transformed(Mesh mesh, double scale, const Vec3& shift) {
  for (Vec3& v : mesh.vertices) v = scale * v + shift;
  return mesh;
}

// Without symmetry, with parts that occlude others, and off centre.
Mesh two_bodies() {
  Mesh small = shapes::tetrahedron();
  for (Vec3& v : small.vertices) v *= 0.4;
  return transformed(shapes::joined(shapes::bumpy_sphere(2), small, {1.5, 0.8, 1.1}), 1, {7, -3, 2});
}

struct Axes {
  Vec3 forward, right, up;
};
Axes axes_of(const Scan& scan, const Mesh& mesh, const ScanOptions& options) {
  const Vec3 forward = (area_centroid(mesh) - scan.camera).normalized();
  const Vec3 right = forward.cross(options.up == UpAxis::y ? Vec3::UnitY() : Vec3::UnitZ()).normalized();
  return {forward, right, right.cross(forward)};
}

TEST(SimulateScan, CamerasStandAtTheCornersOfAnIcosahedronInTheOrderOfTheBenchmark) {
  const Mesh mesh = two_bodies();
  const double distance = 3 * std::sqrt(surface_area(mesh));
  for (int view = 0; view < kViews; ++view) {
    const Vec3 expected = area_centroid(mesh) + distance * kViewDirections[view].normalized();
    EXPECT_LT((simulate_scan(mesh, view).camera - expected).norm(), 1e-9 * distance) << "view " << view;
  }
}

TEST(SimulateScan, EqualsBruteForceRayCastingWhereverItStandsAndWhateverItsUnit) {
  for (const auto& [scale, shift] : {std::pair(1.0, 0.0), {1e-7, 1e-3}, {1e6, 4e8}}) {
    const Mesh mesh = transformed(two_bodies(), scale, Vec3(1, -2, 0.5) * shift);
    for (int view = 0; view < kViews; view += scale == 1 ? 1 : 4) {
      const ScanOptions options{.step_degrees = 0.9,
                                .up = view % 3 == 0 ? UpAxis::y : UpAxis::z,
                                .phase = view % 2 == 0 ? 0.0 : 0.3};
      const double step = std::tan(options.step_degrees * std::numbers::pi / 180);
      const Scan scan = simulate_scan(mesh, view, options);
      const auto [forward, right, up] = axes_of(scan, mesh, options);
      std::vector<Vec3> expected;
      for (int row = 27; row >= -27; --row)
        for (int column = -27; column <= 27; ++column) {
          const double x = (column + options.phase) * step, y = (row + options.phase) * step;
          if (const FirstHit hit = met_by(mesh, scan.camera, forward + x * right + y * up))
            expected.push_back(hit.point_in(mesh));
        }
      ASSERT_GT(expected.size(), 60U);
      ASSERT_EQ(scan.points.size(), expected.size()) << "view " << view << " scale " << scale;
      for (std::size_t i = 0; i < expected.size(); ++i)
        ASSERT_LT((scan.points[i] - expected[i]).norm(), (scale == 1 ? 1e-9 : 1e-7 * scale))
            << "view " << view << " point " << i;
    }
  }
}

TEST(SimulateScan, FollowsTheMeshesUnitExactly) {
  const Mesh mesh = two_bodies();
  const double scale = 1 << 20;  // a power of two is exact
  const Scan scan = simulate_scan(mesh, 4), large = simulate_scan(transformed(mesh, scale, {0, 0, 0}), 4);
  ASSERT_EQ(scan.points.size(), large.points.size());
  for (std::size_t i = 0; i < scan.points.size(); ++i) ASSERT_EQ(large.points[i], scale * scan.points[i]);
}

TEST(ScanScene, GivesEveryViewTheScanThatItHasAlone) {
  const Mesh mesh = two_bodies(), other = transformed(mesh, 1.5, {1, 0, 0});
  const ScanScene scene(mesh), of_other(other);
  const auto views = same_in_threads_at_once([&] {
    std::vector<std::vector<Vec3>> points;
    for (int view = kViews - 1; view >= 0; --view) points.push_back(scene.scan(view).points);
    return points;
  });
  for (int view = 0; view < kViews; ++view)
    EXPECT_EQ(views[index(kViews - 1 - view)], simulate_scan(mesh, view).points);
  EXPECT_NE(scene.scan(6).points, of_other.scan(6).points);
}

TEST(ScanScene, LeavesNothingBehind) {
  Mesh mesh = two_bodies();
  const Scan first = ScanScene(mesh).scan(6);
  mesh.vertices[3] += Vec3(0.4, 0, 0);  // moved into the same memory
  EXPECT_NE(ScanScene(mesh).scan(6).points, first.points);
}

TEST(SimulateScan, ADoubledFaceCountsOnce) {
  Mesh mesh = shapes::bumpy_sphere(2);
  const Scan once = simulate_scan(mesh, 3);
  const double distance = 3 * std::sqrt(surface_area(mesh));
  mesh.faces.insert(mesh.faces.end(), mesh.faces.rbegin(), mesh.faces.rend());
  const Scan twice = simulate_scan(mesh, 3, {.distance = distance / std::sqrt(surface_area(mesh))});
  ASSERT_EQ(once.points.size(), twice.points.size());
  for (std::size_t i = 0; i < once.points.size(); ++i)
    ASSERT_LT((once.points[i] - twice.points[i]).norm(), 1e-9);
}

TEST(SimulateScan, ThinPlateIsSeenFromBothSidesButNotEdgeOn) {
  const Mesh plate = shapes::grid(8);  // in the plane z = 0
  EXPECT_EQ(simulate_scan(plate, 0).points.size(), simulate_scan(plate, 1).points.size());
  EXPECT_GT(simulate_scan(plate, 0).points.size(), 1000U);
  for (const int in_the_plane : {3, 4, 5, 6}) EXPECT_THROW(simulate_scan(plate, in_the_plane), InputError);
}

TEST(SimulateScan, SlenderShapeThatPassesTheCameraIsCutAtTheWidestField) {
  Mesh needle = shapes::tetrahedron();
  for (Vec3& v : needle.vertices) v.z() *= 1e5;
  const Scan scan = simulate_scan(needle, 8, {.step_degrees = 1});
  const Vec3 forward = (area_centroid(needle) - scan.camera).normalized();
  double widest = 0;
  for (const Vec3& p : scan.points) {
    const Vec3 ray = p - scan.camera;
    widest = std::max(widest, std::acos(forward.dot(ray) / ray.norm()));
  }
  EXPECT_GT(widest, 0.9 * kMaxHalfField);
  EXPECT_LT(widest, std::numbers::pi / 2);
}

TEST(SimulateScan, VerticesWithoutAFaceDoNotCount) {
  Mesh mesh = two_bodies();
  const Scan expected = simulate_scan(mesh, 2);
  mesh.vertices.emplace_back(1e4, 0, 0);
  mesh.vertices.emplace_back(std::nan(""), 0, 0);
  EXPECT_EQ(simulate_scan(mesh, 2).points, expected.points);
}

TEST(SimulateScan, RefusesWhatCannotBeSeen) {
  EXPECT_THROW(simulate_scan({}, 0), InputError);
  EXPECT_THROW(simulate_scan({{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}, {{0, 1, 2}}}, 0), InputError);
  Mesh broken = shapes::tetrahedron();
  broken.vertices[2].y() = kInfinity;
  EXPECT_THROW(simulate_scan(broken, 0), InputError);
  EXPECT_THROW(simulate_scan(transformed(shapes::tetrahedron(), 1e200, {0, 0, 0}), 0), InputError);
}

}  // namespace
}  // namespace salbench
