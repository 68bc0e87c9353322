// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/scan/scan.h"

#include <thread>

#include "stages/geometry/mesh_ops.h"
#include "stages/geometry/neighbours.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

constexpr double kC = 0.85065, kD = 0.52573;
const Vec3 kViewDirections[kViews] = {{0, kD, -kC},  {0, kD, kC},  {0, -kD, kC},  {-kD, kC, 0},
                                      {-kD, -kC, 0}, {kD, kC, 0},  {kD, -kC, 0},  {0, -kD, -kC},
                                      {kC, 0, kD},   {-kC, 0, kD}, {-kC, 0, -kD}, {kC, 0, -kD}};

// Without symmetry, with parts that occlude others, and off centre.
Mesh two_bodies() {
  Mesh mesh = shapes::bumpy_sphere(2);
  Mesh small = shapes::tetrahedron();
  const auto first = static_cast<std::int32_t>(mesh.vertices.size());
  for (const Vec3& v : small.vertices) mesh.vertices.push_back(0.4 * v + Vec3(1.5, 0.8, 1.1));
  for (const Triangle& face : small.faces)
    mesh.faces.push_back({face[0] + first, face[1] + first, face[2] + first});
  for (Vec3& v : mesh.vertices) v += Vec3(7, -3, 2);
  return mesh;
}

Mesh transformed(Mesh mesh, double scale, const Vec3& shift) {
  for (Vec3& v : mesh.vertices) v = scale * v + shift;
  return mesh;
}

double distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (p - a - t * (b - a)).norm();
}

double distance_to_mesh(const Vec3& p, const Mesh& mesh) {
  double least = kInfinity;
  for (const Triangle& face : mesh.faces) {
    const Vec3 v[3] = {mesh.vertices[static_cast<std::size_t>(face[0])],
                       mesh.vertices[static_cast<std::size_t>(face[1])],
                       mesh.vertices[static_cast<std::size_t>(face[2])]};
    const Vec3 normal = face_area_vector(mesh, face).normalized();
    bool above = true;
    for (int k = 0; k < 3; ++k) {
      above = above && normal.dot((v[(k + 1) % 3] - v[k]).cross(p - v[k])) >= 0;
      least = std::min(least, distance_to_segment(p, v[k], v[(k + 1) % 3]));
    }
    if (above) least = std::min(least, std::abs(normal.dot(p - v[0])));
  }
  return least;
}

// Nearest hit over all faces, by solving for the plane and two coordinates in it.
std::optional<Vec3> nearest_hit(const Mesh& mesh, const Vec3& from, const Vec3& direction) {
  double nearest = kInfinity;
  for (const Triangle& face : mesh.faces) {
    const Vec3& a = mesh.vertices[static_cast<std::size_t>(face[0])];
    Eigen::Matrix3d system;
    system << direction, a - mesh.vertices[static_cast<std::size_t>(face[1])],
        a - mesh.vertices[static_cast<std::size_t>(face[2])];
    if (system.determinant() == 0) continue;
    const Vec3 solution = system.inverse() * (a - from);
    if (solution[1] < 0 || solution[2] < 0 || solution[1] + solution[2] > 1 || solution[0] <= 0) continue;
    nearest = std::min(nearest, solution[0]);
  }
  if (!std::isfinite(nearest)) return {};
  return from + nearest * direction;
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

TEST(SimulateScan, EqualsBruteForceRayCasting) {
  const Mesh mesh = two_bodies();
  for (int view = 0; view < kViews; ++view) {
    const ScanOptions options{
        .step_degrees = 0.6, .up = view % 3 == 0 ? UpAxis::y : UpAxis::z, .phase = view % 2 == 0 ? 0.0 : 0.3};
    const double step = std::tan(options.step_degrees * std::numbers::pi / 180);
    const Scan scan = simulate_scan(mesh, view, options);
    const auto [forward, right, up] = axes_of(scan, mesh, options);
    std::vector<Vec3> expected;
    for (int row = 40; row >= -40; --row)
      for (int column = -40; column <= 40; ++column) {
        const double x = (column + options.phase) * step, y = (row + options.phase) * step;
        if (const auto hit = nearest_hit(mesh, scan.camera, forward + x * right + y * up))
          expected.push_back(*hit);
      }
    ASSERT_GT(expected.size(), 150U);
    ASSERT_EQ(scan.points.size(), expected.size()) << "view " << view;
    for (std::size_t i = 0; i < expected.size(); ++i)
      ASSERT_LT((scan.points[i] - expected[i]).norm(), 1e-9) << "view " << view << " point " << i;
  }
}

TEST(SimulateScan, EveryPointLiesOnTheMeshWhereverItStandsAndWhateverItsUnit) {
  for (const auto& [scale, shift] : {std::pair(1.0, 0.0), std::pair(1e-7, 1e-3), std::pair(1e6, 4e8)}) {
    const Mesh mesh = transformed(two_bodies(), scale, Vec3(1, -2, 0.5) * shift);
    const double tolerance = 1e-5 * bounding_radius(mesh.vertices);
    for (const int view : {0, 5, 9}) {
      const Scan scan = simulate_scan(mesh, view);
      for (std::size_t i = 0; i < scan.points.size(); i += 11)
        ASSERT_LT(distance_to_mesh(scan.points[i], mesh), tolerance) << "view " << view << " scale " << scale;
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

TEST(SimulateScan, DoesNotDependOnOtherThreads) {
  const Mesh mesh = two_bodies();
  const ScanScene scene(mesh);
  std::vector<Scan> alone(kViews), together(kViews);
  for (int view = 0; view < kViews; ++view) alone[static_cast<std::size_t>(view)] = scene.scan(view);
  std::vector<std::thread> threads;
  for (int first = 0; first < 4; ++first) {
    threads.emplace_back([&, first] {
      for (int view = first; view < kViews; view += 4)
        together[static_cast<std::size_t>(view)] = scene.scan(view);
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (std::size_t view = 0; view < kViews; ++view) EXPECT_EQ(alone[view].points, together[view].points);
}

TEST(ScanScene, GivesEveryViewTheScanThatItHasAlone) {
  const Mesh mesh = two_bodies(), other = transformed(mesh, 1.5, {1, 0, 0});
  const ScanScene scene(mesh), of_other(other);
  for (int view = kViews - 1; view >= 0; --view) {
    EXPECT_EQ(scene.scan(view).points, simulate_scan(mesh, view).points);
    EXPECT_EQ(of_other.scan(view).points, simulate_scan(other, view).points);
  }
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
  ScanOptions same_distance;
  same_distance.distance = distance / std::sqrt(surface_area(mesh));
  const Scan twice = simulate_scan(mesh, 3, same_distance);
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
  ScanOptions coarse;
  coarse.step_degrees = 1;
  const Scan scan = simulate_scan(needle, 8, coarse);
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
