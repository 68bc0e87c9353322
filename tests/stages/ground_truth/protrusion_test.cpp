// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/ground_truth/simulation.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

TEST(Protrusion, OfASphereIsThatOfTheSphereItShrinksTo) {
  // Diffusion for a time unit^2 shrinks the unit sphere to radius exp(-2 unit^2). The first step is nearly
  // exact; later ones also drift along the surface around the 12 vertices with five neighbours.
  for (const int levels : {3, 4, 5}) {  // 642, 2562 and 10242 vertices: independent of density
    for (const auto& [scale, tolerance] : {std::pair(0.003, 0.02), std::pair(0.03, 0.18)}) {
      const double unit = scale * std::sqrt(4 * std::numbers::pi);
      const double expected = (1 - std::exp(-2 * unit * unit)) / unit;
      const ScalarField field = protrusion(shapes::sphere(levels), scale);
      const auto [least, most] = std::ranges::minmax_element(field);
      EXPECT_GT(*least / expected, 1 - tolerance) << levels << " levels, scale " << scale;
      EXPECT_LT(*most / expected, 1 + tolerance) << levels << " levels, scale " << scale;
      const double sum = std::accumulate(field.begin(), field.end(), 0.0);
      EXPECT_NEAR(sum / static_cast<double>(field.size()) / expected, 1, 0.02)
          << levels << " levels, scale " << scale;
    }
  }
}

TEST(Protrusion, OfASphereFromInsideIsAHollow) {
  Mesh mesh = shapes::sphere(3);
  for (Triangle& face : mesh.faces) std::swap(face[1], face[2]);
  const ScalarField outside = protrusion(shapes::sphere(3), 0.05), inside = protrusion(mesh, 0.05);
  for (std::size_t i = 0; i < inside.size(); ++i) EXPECT_NEAR(inside[i], -outside[i], 1e-12);
}

TEST(Protrusion, OfAFlatSheetIsZeroUpToItsBorder) {
  Mesh mesh = shapes::grid(20);
  for (const double value : protrusion(mesh, 0.05)) EXPECT_NEAR(value, 0, 1e-12);
}

TEST(Protrusion, IsGreatestAtTheTipOfASpike) {
  Mesh mesh = shapes::sphere(4);
  const auto tip = static_cast<std::size_t>(
      std::ranges::max_element(mesh.vertices, [](const Vec3& a, const Vec3& b) { return a.z() < b.z(); }) -
      mesh.vertices.begin());
  const Vec3 axis = mesh.vertices[tip];
  for (Vec3& v : mesh.vertices) v *= 1 + 0.5 * std::exp(-(v - axis).squaredNorm() / (2 * 0.15 * 0.15));
  const ScalarField field = protrusion(mesh, 0.03);
  EXPECT_EQ(static_cast<std::size_t>(std::ranges::max_element(field) - field.begin()), tip);
  EXPECT_LT(*std::ranges::min_element(field), 0);  // the hollow around its foot
}

TEST(Protrusion, DoesNotDependOnUnitAndPlace) {
  const Mesh mesh = shapes::bumpy_sphere(3);
  Mesh moved = mesh;
  for (Vec3& v : moved.vertices) v = 1000 * Vec3(v.y(), v.z(), v.x()) + Vec3(5000, -300, 70);
  const ScalarField expected = protrusion(mesh, 0.03), field = protrusion(moved, 0.03);
  for (std::size_t i = 0; i < field.size(); ++i) EXPECT_NEAR(field[i], expected[i], 1e-9);
}

TEST(Protrusion, IsZeroWhereThereIsNoSurface) {
  Mesh mesh = shapes::sphere(1);
  mesh.vertices.emplace_back(7, 7, 7);  // isolated
  const ScalarField field = protrusion(mesh, 0.03);
  EXPECT_EQ(field.back(), 0);
  EXPECT_GT(field.front(), 0);
  EXPECT_THAT(protrusion({shapes::random_cloud(9, 1), {}}, 0.03), Each(0));
  EXPECT_THAT(protrusion({std::vector<Vec3>(3, Vec3(1, 2, 3)), {{0, 1, 2}}}, 0.03), Each(0));
  EXPECT_TRUE(protrusion({}, 0.03).empty());
}

}  // namespace
}  // namespace salbench
