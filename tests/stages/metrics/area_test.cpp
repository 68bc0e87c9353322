// SPDX-License-Identifier: GPL-3.0-or-later
// Effect of weighing by area: a surface with another mesh gets the same values.

#include "stages/geometry/mesh_ops.h"
#include "stages/metrics/score.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }

// A mesh with a map and a ground truth that are constant on patches, and picks at some vertices.
struct Marked {
  Mesh mesh;
  ScalarField map;
  GroundTruth truth;
};

Marked patches() {
  Marked marked{shapes::bumpy_sphere(3), {}, {}};
  Rng rng(1, "patches", "");
  for (const Vec3& v : marked.mesh.vertices) {
    const bool front = v.x() > 0.2, top = v.z() > 0.1, right = v.y() > -0.3;
    marked.map.push_back(front ? (top ? 1.0 : 0.4) : right ? 0.25 : 0.0);
    marked.truth.saliency.push_back(top ? (right ? 1.0 : 0.5) : v.x() > 0.5 ? 0.2 : 0.0);
  }
  marked.truth.picks.resize(3);
  for (int k = 0; k < 60; ++k)
    marked.truth.picks[at(k % 3)].push_back(static_cast<std::int32_t>(rng.below(marked.map.size())));
  return marked;
}

// Splits faces within a patch into three at their centre, `rounds` times over: the same surface with the same
// values.
Marked subdivided(Marked marked, double fraction, int rounds) {
  Rng rng(2, "subdivided", "");
  for (int round = 0; round < rounds; ++round) {
    Faces faces;
    for (const Triangle& face : marked.mesh.faces) {
      const auto [a, b, c] = face;
      const auto same = [&](const ScalarField& field) {
        return field[at(a)] == field[at(b)] && field[at(b)] == field[at(c)];
      };
      // Unevenly: whole parts of the surface are unchanged.
      const bool here = marked.mesh.vertices[at(a)].x() > -0.2 && rng.uniform() < fraction;
      if (!here || !same(marked.map) || !same(marked.truth.saliency)) {
        faces.push_back(face);
        continue;
      }
      const auto centre = static_cast<std::int32_t>(marked.mesh.vertices.size());
      marked.mesh.vertices.push_back(
          (marked.mesh.vertices[at(a)] + marked.mesh.vertices[at(b)] + marked.mesh.vertices[at(c)]) / 3);
      marked.map.push_back(marked.map[at(a)]);
      marked.truth.saliency.push_back(marked.truth.saliency[at(a)]);
      faces.insert(faces.end(), {{a, b, centre}, {b, c, centre}, {c, a, centre}});
    }
    marked.mesh.faces = std::move(faces);
  }
  return marked;
}

double cc_area(const ScalarField& map, const GroundTruth& truth, const ScalarField& areas) {
  const MetricsOptions options{.names = {"cc_area"}};
  return score(chosen_metrics(options), map, truth, options, Rng(1, "scores", "x"),
               {.size = map.size(), .areas = areas})
      .values[0];
}
double cc_area(const Marked& marked) {
  return cc_area(marked.map, marked.truth, barycentric_areas(marked.mesh.vertices, marked.mesh.faces));
}

TEST(ByArea, SubdividingFacesInPlaceChangesNothing) {
  const Marked coarse = patches(), fine = subdivided(coarse, 0.7, 2);
  ASSERT_GT(fine.map.size(), 3 * coarse.map.size() / 2);
  EXPECT_NEAR(cc_area(fine), cc_area(coarse), 1e-6);
  EXPECT_GT(std::abs(cc(fine.map, fine.truth.saliency) - cc(coarse.map, coarse.truth.saliency)), 1e-3)
      << "it weighs vertices, and must see that there are more of them";
}

TEST(ByArea, BarycentricAreasSumToTheSurface) {
  const Mesh mesh = shapes::bumpy_sphere(2);
  const ScalarField areas = barycentric_areas(mesh.vertices, mesh.faces);
  EXPECT_NEAR(std::accumulate(areas.begin(), areas.end(), 0.0), surface_area(mesh), 1e-12);
  const ScalarField corner =
      barycentric_areas(std::vector<Vec3>{{0, 0, 0}, {3, 0, 0}, {0, 2, 0}, {9, 9, 9}}, Faces{{0, 1, 2}});
  EXPECT_EQ(corner, (ScalarField{1, 1, 1, 0}));
}

TEST(ByArea, IsUndefinedWithoutAreas) {
  for (const ScalarField& areas : {ScalarField{}, ScalarField(3, 0.0)})
    EXPECT_TRUE(std::isnan(cc_area({1, 5, 2}, {{1, 3, 2}, {{1}}}, areas)));
}

}  // namespace
}  // namespace salbench
