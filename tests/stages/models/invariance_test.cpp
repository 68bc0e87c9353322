// SPDX-License-Identifier: GPL-3.0-or-later
// Invariance of maps to position, rotation, scale and numbering of the points, with the listed exceptions.
// docs/invariance.md has the same for real meshes, in scores. Maps are also independent of the number of
// threads.

#include "stages/core/field.h"
#include "tests/support/mesh_models.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"
#include "tests/support/threads.h"

namespace salbench {
namespace {

// Hills without symmetry over a square, open at its border. 2^12 vertices whose coordinates are multiples of
// 2^-16: their centroid is exact, and remains so under integer shifts. More faces than MS keeps.
Mesh landscape() {
  Mesh mesh = shapes::grid(63);
  for (Vec3& v : mesh.vertices) {
    v.z() = 0.1 * std::sin(9 * v.x() + 0.3) * std::sin(7 * v.y() + 1.1) +
            0.05 * std::sin(23 * v.x() * v.y()) + 0.03 * v.x();
    v = (65536 * v).array().round() / 65536;
  }
  return mesh;
}

using Maps = std::vector<ScalarField>;  // in the order of kMeshModels

Maps maps_of(const Mesh& mesh) {
  const DescribedMesh described(mesh);
  Maps maps;
  for (const MeshModel& model : kMeshModels) maps.push_back(model.map(described));
  return maps;
}

template <class Place>
Maps maps_where(const Place& place) {
  return maps_of(FramedMesh(landscape(), place).mesh);
}

// CS aligns a grid with the origin and axes of coordinates.
bool has_a_grid(std::string_view model) { return model == "CS"; }
// VIS uses directions that do not rotate with the shape.
bool has_directions(std::string_view model) { return model == "VIS"; }

TEST(Invariance, ScaleByAPowerOfTwoIsExact) {
  const Maps maps = maps_of(landscape());
  for (const double factor : {1.0 / 128, 4096.0}) {
    const Maps scaled = maps_where([&](const Vec3& v) { return Vec3(factor * v); });
    for (std::size_t m = 0; m < maps.size(); ++m)
      EXPECT_EQ(scaled[m], maps[m]) << kMeshModels[m].name << " times " << factor;
  }
}

TEST(Invariance, ShiftByWholeNumbersIsExact) {
  const Maps maps = maps_of(landscape());
  const Maps shifted = maps_where([&](const Vec3& v) { return Vec3(v + Vec3(2, -3, 50)); });
  for (std::size_t m = 0; m < maps.size(); ++m)
    EXPECT_TRUE(shifted[m] == maps[m] || has_a_grid(kMeshModels[m].name)) << kMeshModels[m].name;
}

TEST(Invariance, HalfTurnsAboutTheAxesAreExact) {
  const Maps maps = maps_of(landscape());
  for (const Vec3& signs : {Vec3(1, -1, -1), Vec3(-1, 1, -1), Vec3(-1, -1, 1)}) {
    const Maps turned = maps_where([&](const Vec3& v) { return Vec3(v.cwiseProduct(signs)); });
    for (std::size_t m = 0; m < maps.size(); ++m) {
      const std::string_view model = kMeshModels[m].name;
      if (has_a_grid(model) || has_directions(model)) continue;
      // Sums of LVJ follow the order of the search tree, which is mirrored.
      EXPECT_THAT(turned[m], Pointwise(DoubleNear(model == "LVJ" ? 1e-12 : 0), maps[m])) << model;
    }
  }
}

TEST(Invariance, ToTheNumberOfThreadsIsExact) {
  const Mesh mesh = landscape();
  same_on_any_number_of_threads([&] { return maps_of(mesh); });
}

// Mean difference between min-max-normalised maps, by frame in the order of the table: for most models, and
// for those that depend on a frame by more than rounding.
using Tolerances = std::array<double, kRandomFrames.size()>;
constexpr Tolerances kRounding = {1e-12, 1e-12, 1e-12, 1e-12};
const std::map<std::string_view, Tolerances> kOtherTolerances = {
    {"LS", {1e-7, 1e-12, 1e-12, 1e-4}},   // among equally similar points, the number decides
    {"CS", {0.05, 5e-3, 0.05, 5e-3}},     // some points lie on borders of the grid
    {"MS", {1e-9, 1e-9, 1e-9, 1e-9}},     // this shape has no repeated eigenvalues
    {"LVJ", {0.1, 1e-12, 1e-12, 1e-12}},  // the unit is the diagonal of the bounding box
    {"VIS", {0.05, 1e-12, 1e-12, 1e-12}}, {"VD", {0, 0, 0, 0}},
};

double tolerance(std::string_view model, std::size_t frame) {
  const auto other = kOtherTolerances.find(model);
  return (other == kOtherTolerances.end() ? kRounding : other->second)[frame];
}

double mean_difference(const ScalarField& a, const ScalarField& b) {
  const ScalarField u = min_max_normalised(a), v = min_max_normalised(b);
  double sum = 0;
  for (std::size_t i = 0; i < u.size(); ++i) sum += std::abs(u[i] - v.at(i));
  return sum / static_cast<double>(u.size());
}

TEST(Invariance, InRandomFramesMapsStayWithinTheirTolerance) {
  const Mesh mesh = landscape();
  const Maps maps = maps_of(mesh);
  for (std::size_t frame = 0; frame < kRandomFrames.size(); ++frame) {
    const FramedMesh framed = kRandomFrames[frame].of(mesh, Rng(0, kRandomFrames[frame].name, ""));
    const Maps there = maps_of(framed.mesh);
    for (std::size_t m = 0; m < maps.size(); ++m)
      EXPECT_LE(mean_difference(framed.in_order_before(there[m]), maps[m]),
                tolerance(kMeshModels[m].name, frame))
          << kMeshModels[m].name << ", " << kRandomFrames[frame].name;
  }
}

}  // namespace
}  // namespace salbench
