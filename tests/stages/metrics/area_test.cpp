// SPDX-License-Identifier: GPL-3.0-or-later
// What weighing by area is for: a surface meshed otherwise gets the same values.
#include <cmath>
#include <map>
#include <numeric>
#include <string>

#include <gtest/gtest.h>

#include "stages/core/errors.h"
#include "stages/geometry/centre.h"
#include "stages/geometry/mesh_ops.h"
#include "stages/metrics/metrics.h"
#include "tests/support/shapes.h"

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
      // Unevenly: whole parts of the surface stay as they are.
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

std::map<std::string, double> all_scores(const Marked& marked) {
  ScalarField centre_bias = marked.map;  // constant on patches, too
  for (double& value : centre_bias) value = std::sqrt(1 + value);
  Measures measures(marked.map.size(), barycentric_areas(marked.mesh.vertices, marked.mesh.faces),
                    centre_bias);
  measures.negatives = centre_bias;
  const Rng draws(1, "scores", "x");
  const Scores scores = score(metric_table(), marked.map, marked.truth, {}, draws, measures);
  std::map<std::string, double> values;
  for (std::size_t m = 0; m < scores.values.size(); ++m)
    if (!metric_table()[m].reads_surface) values[metric_table()[m].name] = scores.values[m];
  return values;
}

TEST(ByArea, SubdividingFacesInPlaceChangesNothing) {
  const Marked coarse = patches(), fine = subdivided(coarse, 0.7, 2);
  ASSERT_GT(fine.map.size(), 3 * coarse.map.size() / 2);
  const auto before = all_scores(coarse), after = all_scores(fine);
  for (const Metric& metric : metric_table()) {
    if (metric.reads_surface) continue;
    const double change = std::abs(after.at(metric.name) - before.at(metric.name));
    ASSERT_TRUE(std::isfinite(change)) << metric.name;
    if (metric.weighting == Weighting::area)
      EXPECT_LT(change, 1e-6) << metric.name;
    else
      EXPECT_GT(change, 1e-3) << metric.name << " weighs vertices: it must see that there are more of them";
  }
}

// 2^1017 and more: their sum overflows.
TEST(ByArea, HugeAreasGiveWhatOnesInAnotherUnitDo) {
  const Marked marked = patches();
  ScalarField areas = barycentric_areas(marked.mesh.vertices, marked.mesh.faces), huge = areas;
  for (double& area : huge) area = std::ldexp(area, 1024);
  const auto scores = [&](const ScalarField& weights) {
    return score(metric_table(), marked.map, marked.truth, {}, Rng(1, "scores", "x"), weights,
                 distances_from_centroid(marked.mesh.vertices))
        .values;
  };
  ASSERT_TRUE(std::isinf(std::accumulate(huge.begin(), huge.end(), 0.0)));
  const std::vector<double> expected = scores(areas), found = scores(huge);
  for (std::size_t m = 0; m < expected.size(); ++m)
    EXPECT_TRUE(found[m] == expected[m] || metric_table()[m].reads_others || metric_table()[m].reads_surface)
        << metric_table()[m].name;
  huge[3] = HUGE_VAL;
  EXPECT_THROW(scores(huge), InputError);
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
  const GroundTruth truth{{1, 3, 2}, {{1}}};
  for (const ScalarField& areas : {ScalarField{}, ScalarField(3, 0.0)}) {
    const Scores scores = score(metric_table(), {1, 5, 2}, truth, {}, Rng(1, "scores", "x"), areas);
    for (std::size_t m = 0; m < scores.values.size(); ++m)
      EXPECT_EQ(std::isnan(scores.values[m]),
                metric_table()[m].weighting == Weighting::area || metric_table()[m].reads_positions ||
                    metric_table()[m].reads_others || metric_table()[m].reads_surface)
          << metric_table()[m].name;
  }
}

}  // namespace
}  // namespace salbench
