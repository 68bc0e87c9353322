// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/geometry/smoothing.h"

#include "io/shapes/mesh_file.h"
#include "stages/core/rng.h"
#include "stages/geometry/mesh_ops.h"
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
        const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
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
  for (const double sigma : {0.01, 0.06, 0.2}) {
    SmoothingOptions options;
    options.sigma = sigma;
    const PicksOfAll picks = random_picks(7, mesh.vertices.size(), 5);
    const ScalarField expected = by_definition(mesh, picks, sigma, 3);
    const ScalarField field = smoothed_picks(mesh, picks, options);
    for (std::size_t v = 0; v < field.size(); ++v)
      EXPECT_NEAR(field[v], expected[v], 1e-12) << "vertex " << v;
  }
}

TEST(SmoothedPicks, FallOffAlongTheEdgesOfAGridAndStopAtTheCut) {
  // Unit area, so sigma is 0.02 here: a vertex of the grid is 1, 2 and 3 deviations from the next ones in its
  // row.
  const Mesh mesh = shapes::grid(50);
  SmoothingOptions options;
  options.sigma = 0.02;
  options.cut = 2.5;
  const std::int32_t middle = 25 * 51 + 25;
  const ScalarField field = smoothed_picks(mesh, PicksOfAll{{middle}}, options);
  const auto at = [&](std::int32_t i) { return field[static_cast<std::size_t>(i)]; };
  EXPECT_DOUBLE_EQ(at(middle), 1);
  EXPECT_NEAR(at(middle + 1), std::exp(-0.5), 1e-12);
  EXPECT_NEAR(at(middle + 2), std::exp(-2), 1e-12);
  EXPECT_EQ(at(middle + 3), 0);
  EXPECT_NEAR(at(middle + 52), std::exp(-1), 1e-12);  // an edge along the cells' diagonal
  EXPECT_NEAR(at(middle + 50), std::exp(-2), 1e-12);  // across it: two edges
}

TEST(SmoothedPicks, DoNotCrossFromOneComponentToAnother) {
  Mesh mesh = shapes::tetrahedron();
  const Mesh twin = mesh;
  for (const Vec3& v : twin.vertices) mesh.vertices.push_back(v + Vec3(1e-6, 0, 0));
  for (const auto& [a, b, c] : twin.faces) mesh.faces.push_back({a + 4, b + 4, c + 4});
  EXPECT_THAT(smoothed_picks(mesh, PicksOfAll{{0}}), ElementsAre(1, 0, 0, 0, 0, 0, 0, 0));
}

// A ball on a ground of two huge faces, which make up nearly all of the surface: most of the ball is in reach
// of each pick.
Mesh statue(unsigned int subdivisions) {
  Mesh mesh = shapes::sphere(subdivisions);
  const auto first = static_cast<std::int32_t>(mesh.vertices.size());
  for (const Vec3& corner : {Vec3(-30, -30, -1), Vec3(30, -30, -1), Vec3(30, 30, -1), Vec3(-30, 30, -1)})
    mesh.vertices.push_back(corner);
  mesh.faces.push_back({first, first + 1, first + 2});
  mesh.faces.push_back({first, first + 2, first + 3});
  return mesh;
}

TEST(SmoothedPicks, OfAStatueOnAFloorAreThoseOfTheStatueWithAWiderGaussian) {
  const Mesh mesh = statue(4), ball = shapes::sphere(4);
  const PicksOfAll picks = {{7, 900}, {1300}};
  SmoothingOptions wider;
  wider.sigma *= std::sqrt(surface_area(mesh) / surface_area(ball));
  ScalarField expected = smoothed_picks(ball, picks, wider);
  EXPECT_GT(std::ranges::count_if(expected, [](double value) { return value > 0; }), 2000);
  expected.resize(mesh.vertices.size());  // 0 on the ground
  const ScalarField field = smoothed_picks(mesh, picks);
  ASSERT_EQ(field.size(), expected.size());
  for (std::size_t v = 0; v < field.size(); ++v) EXPECT_NEAR(field[v], expected[v], 1e-12) << "vertex " << v;
}

TEST(SmoothedPicks, AreRefusedWherePicksReachTooManyInAll) {
  const Mesh mesh = statue(6);  // 40,966 vertices
  EXPECT_THAT([&] { smoothed_picks(mesh, random_picks(400, mesh.vertices.size(), 3)); },
              Refuses("more than 5791 others on average"));
}

TEST(SmoothedPicks, AreSharesOfTheParticipants) {
  const Mesh mesh = shapes::tetrahedron();  // edges far beyond the reach
  const PicksOfAll picks = {{0, 1}, {}, {1}, {1, 1, 2}};
  EXPECT_THAT(smoothed_picks(mesh, picks), ElementsAre(0.25, 0.75, 0.25, 0));
  SmoothingOptions group;
  group.per_participant = false;
  EXPECT_THAT(smoothed_picks(mesh, picks, group), ElementsAre(1, 3, 1, 0));
}

TEST(PickSmoother, GivesAnyGroupWhatItsPicksAloneGive) {
  const Mesh mesh = shapes::bumpy_sphere(3);
  const PicksOfAll picks = random_picks(9, mesh.vertices.size(), 2);
  for (const bool per_participant : {true, false}) {
    SmoothingOptions options;
    options.per_participant = per_participant;
    const PickSmoother smooth(mesh, picks, options);
    for (const std::vector<std::size_t>& group :
         std::vector<std::vector<std::size_t>>{{4}, {8, 0}, {7, 3, 5, 1}, {0, 1, 2, 3, 4, 5, 6, 7, 8}}) {
      PicksOfAll of_group;
      for (const std::size_t k : group) of_group.push_back(picks[k]);
      EXPECT_EQ(smooth(group), smoothed_picks(mesh, of_group, options));
    }
  }
}

TEST(PickSmoother, HasNoSuchParticipant) {
  const PicksOfAll picks = {{0}, {1}};
  const PickSmoother smooth(shapes::tetrahedron(), picks);
  EXPECT_THROW(smooth(std::vector<std::size_t>{2}), std::logic_error);
}

TEST(SmoothedPicks, WithoutASurfaceStayAtTheirVertices) {
  const Mesh cloud{shapes::random_cloud(5, 1), {}};
  EXPECT_THAT(smoothed_picks(cloud, PicksOfAll{{3}, {3}}), ElementsAre(0, 0, 0, 1, 0));
  const Mesh line{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}};
  EXPECT_THAT(smoothed_picks(line, PicksOfAll{{1}}), ElementsAre(0, 1, 0));
  const Mesh point{std::vector<Vec3>(3, Vec3(1, 2, 3)), {{0, 1, 2}}};
  EXPECT_THAT(smoothed_picks(point, PicksOfAll{{1}}), Each(1));
}

TEST(SmoothedPicks, OfParticipantsWithoutPicksAreZero) {
  EXPECT_THAT(smoothed_picks(shapes::tetrahedron(), PicksOfAll{{}, {}}), Each(0));
}

TEST(SmoothedPicks, NeedParticipants) {
  EXPECT_THROW(smoothed_picks(shapes::tetrahedron(), PicksOfAll{}), InputError);
  SmoothingOptions group;
  group.per_participant = false;
  EXPECT_THAT(smoothed_picks(shapes::tetrahedron(), PicksOfAll{}, group), Each(0));
}

TEST(SmoothedPicks, NameThePickThatIsNoVertex) {
  for (const std::int32_t wrong : {4, -1})
    EXPECT_THAT(
        [&] {
          smoothed_picks(shapes::tetrahedron(), PicksOfAll{{0}, {2, wrong}});
        },
        Refuses("participant 1 picked vertex " + std::to_string(wrong) + " "));
}

template <class T>
std::vector<T> read_column(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istream_iterator<T>(file), std::istream_iterator<T>()};
}

TEST(SmoothedPicks, ReproduceThePublishedDistributions) {
  const auto data = real_data();
  if (!data) GTEST_SKIP() << kNoRealData;
  const auto folder = *data / "SchellingData";
  int n_meshes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "Distributions")) {
    const std::string name = entry.path().stem();
    const Mesh mesh = read_mesh(folder / "Meshes" / (name + ".off"));
    PicksOfAll picks;
    for (int k = 0;; ++k) {
      const auto path = folder / "RawData" / (name + "_" + std::to_string(k) + ".pid");
      if (!std::filesystem::exists(path)) break;
      picks.push_back(read_column<std::int32_t>(path));
    }
    ASSERT_GE(picks.size(), 22U) << name;
    const auto published = read_column<double>(entry.path());
    const ScalarField field = smoothed_picks(mesh, picks);
    ASSERT_EQ(field.size(), published.size()) << name;
    double worst = 0;
    for (std::size_t v = 0; v < field.size(); ++v) worst = std::max(worst, std::abs(field[v] - published[v]));
    EXPECT_LE(worst, 1e-5) << "mesh " << name;
    ++n_meshes;
  }
  EXPECT_EQ(n_meshes, 19);
}

}  // namespace
}  // namespace salbench
