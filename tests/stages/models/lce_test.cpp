// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/lce.h"

#include "stages/geometry/mesh_ops.h"
#include "tests/stages/models/surfaces.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

ScalarField lce(const Mesh& mesh, const LceOptions& options = {}) {
  return lce_saliency(mesh.vertices, mesh.faces, options);
}

// Every point against every other, with its own shortest paths (Bellman and Ford).
ScalarField entropy_written_out(const Mesh& mesh, const std::vector<std::int32_t>& bins,
                                const ScalarField& areas, const std::vector<double>& radii) {
  const std::size_t n = mesh.vertices.size();
  ScalarField result(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<double> distance(n, kInfinity);
    distance[i] = 0;
    for (bool changed = true; changed;) {
      changed = false;
      for (const Triangle& face : mesh.faces)
        for (const std::int32_t a : face)
          for (const std::int32_t b : face) {
            const auto from = index(a), to = index(b);
            const double through = distance[from] + (mesh.vertices[from] - mesh.vertices[to]).norm();
            if (!(through < distance[to])) continue;
            distance[to] = through;
            changed = true;
          }
    }
    for (const double radius : radii) {
      std::map<std::int32_t, double> area;
      double total = 0;
      for (std::size_t j = 0; j < n; ++j) {
        if (distance[j] > radius) continue;
        area[bins[j]] += areas[j];
        total += areas[j];
      }
      for (const auto& [bin, part] : area)
        result[i] -= part / total * std::log2(part / total) / static_cast<double>(radii.size());
    }
  }
  return result;
}

TEST(LocalEntropy, EqualsTheFormulaWrittenOut) {
  const Mesh mesh = shapes::bumpy_sphere(2);
  std::vector<std::int32_t> bins;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) bins.push_back(static_cast<std::int32_t>(i * i % 7));
  const ScalarField areas = barycentric_areas(mesh.vertices, mesh.faces);
  for (const std::vector<double>& radii : {std::vector<double>{0.9}, {1.1, 0.55, 0.275}})
    EXPECT_THAT(local_entropy(mesh, bins, areas, radii),
                Pointwise(DoubleNear(1e-9), entropy_written_out(mesh, bins, areas, radii)));
}

TEST(LocalEntropy, IsInBitsOfTheAreasOfTheBins) {
  const auto entropy = [](const std::vector<std::int32_t>& bins, const ScalarField& areas) {
    return local_entropy(shapes::tetrahedron(), bins, areas, std::vector<double>{10});
  };
  EXPECT_THAT(entropy({3, 3, 3, 3}, ScalarField(4, 2.0)), Each(0));
  EXPECT_THAT(entropy({0, 1, 1, 0}, ScalarField(4, 2.0)), Each(1));
  EXPECT_THAT(entropy({0, 1, 2, 3}, {3, 1, 0, 0}),
              Each(DoubleNear(-0.75 * std::log2(0.75) - 0.25 * std::log2(0.25), 1e-12)));
}

TEST(Lce, OfConstantCurvatureIsZero) {
  EXPECT_THAT(lce(shapes::sphere(0)), Each(0));  // all vertices are equivalent
  EXPECT_THAT(lce(shapes::cylinder(1, 4, 64, 30)), Each(0));
  EXPECT_THAT(lce(shapes::grid(30)), Each(DoubleNear(0, 1e-9)));
}

TEST(Lce, ALargeSurfaceIsSimplified) {
  const Mesh mesh = shapes::sphere_with_bump(5, 0.1, 0.1);
  const ScalarField coarse = lce(mesh, {.faces = 10000});
  EXPECT_NE(coarse, lce(mesh));
  EXPECT_EQ(coarse.size(), mesh.vertices.size());
}

TEST(LceDegenerate, PointsWithoutFacesTakeTheNearestValue) {
  Mesh mesh = shapes::bumpy_sphere(3);
  mesh.vertices.push_back(1.001 * mesh.vertices[50]);
  const ScalarField saliency = lce(mesh);
  EXPECT_EQ(saliency.back(), saliency[50]);
}

}  // namespace
}  // namespace salbench
