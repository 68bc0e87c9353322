// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/geometry/smoothing.h"

#include "io/shapes/mesh_file.h"
#include "stages/core/rng.h"
#include "stages/geometry/mesh_ops.h"
#include "tests/stages/metrics/published.h"
#include "tests/support/data.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

using PicksOfAll = std::vector<std::vector<std::int32_t>>;

PicksOfAll random_picks(std::size_t participants, std::size_t n_vertices, std::uint64_t seed) {
  Rng rng(seed, "picks", "");
  PicksOfAll picks(participants);
  for (auto& own : picks)
    for (std::uint64_t k = rng.below(12); k > 0; --k)
      own.push_back(static_cast<std::int32_t>(rng.below(n_vertices)));
  return picks;
}

// Brute-force reference: all shortest paths (Floyd and Warshall), and the published formula.
ScalarField by_definition(const Mesh& mesh, const PicksOfAll& picks, double sigma, double cut) {
  const std::size_t n = mesh.vertices.size();
  std::vector<std::vector<double>> path(n, std::vector<double>(n, kInfinity));
  for (std::size_t i = 0; i < n; ++i) path[i][i] = 0;
  for (const Triangle& face : mesh.faces) {
    for (const std::int32_t a : face)
      for (const std::int32_t b : face) {
        const auto i = index(a), j = index(b);
        path[i][j] = (mesh.vertices[i] - mesh.vertices[j]).norm();
      }
  }
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) path[i][j] = std::min(path[i][j], path[i][k] + path[k][j]);

  const double s = sigma * std::sqrt(surface_area(mesh));
  ScalarField field(n, 0.0);
  for (std::size_t v = 0; v < n; ++v) {
    for (std::size_t k = 0; k < n; ++k) {
      const auto count = std::count_if(picks.begin(), picks.end(), [&](const auto& own) {
        return std::find(own.begin(), own.end(), static_cast<std::int32_t>(k)) != own.end();
      });
      const double d = path[v][k];
      if (d <= cut * s) field[v] += static_cast<double>(count) * std::exp(-d * d / (2 * s * s));
    }
    field[v] /= static_cast<double>(picks.size());
  }
  return field;
}

TEST(SmoothedPicks, EqualTheFormulaByDefinition) {
  const Mesh mesh = shapes::bumpy_sphere(2);
  const PicksOfAll picks = random_picks(7, mesh.vertices.size(), 5);
  for (const auto& [sigma, cut] : {std::pair(0.01, 3.0), {0.06, 3}, {0.2, 3}, {0.06, 2.5}})
    EXPECT_THAT(smoothed_picks(mesh, picks, {.sigma = sigma, .cut = cut}),
                Pointwise(DoubleNear(1e-12), by_definition(mesh, picks, sigma, cut)));
}

TEST(SmoothedPicks, DoNotCrossFromOneComponentToAnother) {
  const Mesh mesh = shapes::joined(shapes::tetrahedron(), shapes::tetrahedron(), {1e-6, 0, 0});
  EXPECT_THAT(smoothed_picks(mesh, PicksOfAll{{0}}), ElementsAre(1, 0, 0, 0, 0, 0, 0, 0));
}

// A ball on a ground of two huge faces, which make up nearly all of the surface: most of the ball is in reach
// of each pick.
Mesh statue(int subdivisions) {
  const Mesh ground{{{-30, -30, -1}, {30, -30, -1}, {30, 30, -1}, {-30, 30, -1}}, {{0, 1, 2}, {0, 2, 3}}};
  return shapes::joined(shapes::sphere(subdivisions), ground);
}

TEST(SmoothedPicks, OfAStatueOnAFloorAreThoseOfTheStatueWithAWiderGaussian) {
  const Mesh mesh = statue(4), ball = shapes::sphere(4);
  const PicksOfAll picks = {{7, 900}, {1300}};
  SmoothingOptions wider;
  wider.sigma *= std::sqrt(surface_area(mesh) / surface_area(ball));
  ScalarField expected = smoothed_picks(ball, picks, wider);
  EXPECT_GT(std::ranges::count_if(expected, [](double value) { return value > 0; }), 2000);
  expected.resize(mesh.vertices.size());  // 0 on the ground
  EXPECT_THAT(smoothed_picks(mesh, picks), Pointwise(DoubleNear(1e-12), expected));
}

TEST(SmoothedPicks, AreRefusedWherePicksReachTooManyInAll) {
  const Mesh mesh = statue(5);  // 10,246 vertices
  EXPECT_THAT([&] { smoothed_picks(mesh, random_picks(400, mesh.vertices.size(), 3)); },
              Refuses("others on average"));
}

const SmoothingOptions kGroup{.per_participant = false};

TEST(SmoothedPicks, AreSharesOfTheParticipants) {
  const Mesh mesh = shapes::tetrahedron();  // edges far beyond the reach
  const PicksOfAll picks = {{0, 1}, {}, {1}, {1, 1, 2}};
  EXPECT_THAT(smoothed_picks(mesh, picks), ElementsAre(0.25, 0.75, 0.25, 0));
  EXPECT_THAT(smoothed_picks(mesh, picks, kGroup), ElementsAre(1, 3, 1, 0));
  EXPECT_THAT(smoothed_picks(mesh, PicksOfAll{{}, {}}), Each(0));
  EXPECT_THROW(smoothed_picks(mesh, PicksOfAll{}), InputError);
  EXPECT_THAT(smoothed_picks(mesh, PicksOfAll{}, kGroup), Each(0));
}

TEST(PickSmoother, GivesAnyGroupWhatItsPicksAloneGive) {
  const Mesh mesh = shapes::bumpy_sphere(3);
  const PicksOfAll picks = random_picks(9, mesh.vertices.size(), 2);
  for (const bool per_participant : {true, false}) {
    const SmoothingOptions options{.per_participant = per_participant};
    const PickSmoother smooth(mesh, picks, options);
    for (const std::vector<std::size_t>& group :
         std::vector<std::vector<std::size_t>>{{4}, {8, 0}, {7, 3, 5, 1}, {0, 1, 2, 3, 4, 5, 6, 7, 8}}) {
      PicksOfAll of_group;
      for (const std::size_t k : group) of_group.push_back(picks[k]);
      EXPECT_EQ(smooth(group), smoothed_picks(mesh, of_group, options));
    }
  }
}

TEST(SmoothedPicks, WithoutASurfaceStayAtTheirVertices) {
  const Mesh cloud{shapes::random_cloud(5, 1), {}};
  EXPECT_THAT(smoothed_picks(cloud, PicksOfAll{{3}, {3}}), ElementsAre(0, 0, 0, 1, 0));
  const Mesh line{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}};
  EXPECT_THAT(smoothed_picks(line, PicksOfAll{{1}}), ElementsAre(0, 1, 0));
  const Mesh point{std::vector<Vec3>(3, Vec3(1, 2, 3)), {{0, 1, 2}}};
  EXPECT_THAT(smoothed_picks(point, PicksOfAll{{1}}), Each(1));
}

TEST(SmoothedPicks, NameThePickThatIsNoVertex) {
  for (const std::int32_t wrong : {4, -1}) {
    const PicksOfAll picks = {{0}, {2, wrong}};
    EXPECT_THAT([&] { smoothed_picks(shapes::tetrahedron(), picks); },
                Refuses("participant 1 picked vertex " + std::to_string(wrong) + " "));
  }
}

TEST(SmoothedPicks, ReproduceThePublishedDistributions) {
  const auto data = real_data();
  if (!data) GTEST_SKIP() << kNoRealData;
  for (const int number : published::kMeshes) {
    const GroundTruth truth = published::ground_truth(*data, number);
    ASSERT_GE(truth.picks.size(), 22U) << number;
    const Mesh mesh = read_mesh(*data / "SchellingData" / "Meshes" / (std::to_string(number) + ".off"));
    EXPECT_THAT(smoothed_picks(mesh, truth.picks), Pointwise(DoubleNear(1e-5), truth.saliency)) << number;
  }
}

}  // namespace
}  // namespace salbench
