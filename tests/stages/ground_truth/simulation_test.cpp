// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/ground_truth/simulation.h"

#include "stages/geometry/mesh_ops.h"
#include "stages/geometry/smoothing.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

using testing::IsSubsetOf;

std::vector<Vec3> tip_directions() {
  return {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(-1, -1, -1).normalized()};
}

// A sphere with four horns.
Mesh horned_sphere() {
  Mesh mesh = shapes::sphere(4);
  for (Vec3& v : mesh.vertices) {
    double height = 1;
    for (const Vec3& tip : tip_directions())
      height += 0.5 * std::exp(-(v - tip).squaredNorm() / (2 * 0.12 * 0.12));
    v *= height;
  }
  return mesh;
}

std::size_t number_of_picks(const GroundTruth& truth) {
  return std::accumulate(truth.picks.begin(), truth.picks.end(), std::size_t{0},
                         [](std::size_t sum, const auto& own) { return sum + own.size(); });
}

// Invariants on every mesh: participants with at least one pick, distinct vertices, and saliency computed
// from the picks.
void expect_sound(const GroundTruth& truth, const Mesh& mesh) {
  EXPECT_TRUE(truth.simulated);
  EXPECT_THAT(truth.picks, SizeIs(SimulationOptions{}.participants));
  for (const auto& own : truth.picks) {
    EXPECT_GE(own.size(), 1U);
    EXPECT_EQ(std::set(own.begin(), own.end()).size(), own.size());
  }
  EXPECT_EQ(truth.saliency, smoothed_picks(mesh, truth.picks));  // throws if a pick is no vertex
}

TEST(SimulatedGroundTruth, AgreesOnTheTips) {
  const Mesh mesh = horned_sphere();
  const GroundTruth truth = simulated_ground_truth(mesh, {}, 1, "horns");
  expect_sound(truth, mesh);
  for (const Vec3& tip : tip_directions()) {
    const auto found = std::count_if(truth.picks.begin(), truth.picks.end(), [&](const auto& own) {
      return std::any_of(own.begin(), own.end(), [&](std::int32_t pick) {
        const Vec3& v = mesh.vertices[index(pick)];
        return v.norm() > 1.35 && v.normalized().dot(tip) > 0.9;
      });
    });
    EXPECT_GE(found, 12) << "of 23 participants at " << tip.transpose();
  }
}

TEST(SimulatedGroundTruth, KeepsThePicksOfAParticipantApart) {
  const Mesh mesh = shapes::bumpy_sphere(4);
  const Adjacency adjacency = edge_adjacency(mesh.vertices.size(), mesh.faces);
  EdgeDistances distances(mesh.vertices, adjacency);
  for (const double separation : {0.02, 0.1}) {
    for (const auto& own : simulated_ground_truth(mesh, {.separation = separation}, 1, "bumpy").picks) {
      for (const std::int32_t pick : own) {
        std::vector<std::int32_t> near;
        for (const ReachedPoint& r : distances.from(pick, separation * std::sqrt(surface_area(mesh))))
          if (std::ranges::find(own, r.index) != own.end()) near.push_back(r.index);
        EXPECT_THAT(near, ElementsAre(pick));
      }
    }
  }
}

TEST(SimulatedGroundTruth, DrawsTheNumberOfPicksAroundItsMean) {
  for (const std::int32_t mean : {1, 7, 10}) {
    const GroundTruth truth = simulated_ground_truth(
        shapes::bumpy_sphere(4), {.participants = 400, .picks = mean, .separation = 0}, 1, "bumpy");
    EXPECT_NEAR(static_cast<double>(number_of_picks(truth)) / 400, mean, 0.05 * mean);
    for (const auto& own : truth.picks) {
      EXPECT_GE(2 * own.size(), index(mean));
      EXPECT_LE(2 * own.size(), index(3 * mean));
    }
  }
}

TEST(SimulatedGroundTruth, DependsOnSeedAndItemAlone) {
  const Mesh mesh = shapes::bumpy_sphere(3);
  const GroundTruth truth = simulated_ground_truth(mesh, {}, 1, "52");
  EXPECT_EQ(simulated_ground_truth(mesh, {}, 1, "52").picks, truth.picks);
  EXPECT_EQ(simulated_ground_truth(mesh, {}, 1, "52").saliency, truth.saliency);
  EXPECT_NE(simulated_ground_truth(mesh, {}, 2, "52").picks, truth.picks);
  EXPECT_NE(simulated_ground_truth(mesh, {}, 1, "53").picks, truth.picks);
}

TEST(SimulatedGroundTruth, MoreParticipantsLeaveTheFirstAsTheyWere) {
  const Mesh mesh = shapes::bumpy_sphere(3);
  const auto few = simulated_ground_truth(mesh, {}, 1, "52").picks;
  const auto many = simulated_ground_truth(mesh, {.participants = 40}, 1, "52").picks;
  EXPECT_TRUE(std::equal(few.begin(), few.end(), many.begin()));
}

TEST(SimulatedGroundTruth, SpreadsEvenlyOverAFlatSheet) {
  Mesh mesh = shapes::grid(30);  // x < 1/2 is then stretched to twice the area of the rest
  for (Vec3& v : mesh.vertices) v.x() = v.x() < 0.5 ? 2 * v.x() : v.x() + 0.5;
  const GroundTruth truth = simulated_ground_truth(mesh, {.participants = 300, .separation = 0}, 1, "sheet");
  std::size_t left = 0;
  for (const auto& own : truth.picks)
    for (const std::int32_t pick : own) left += mesh.vertices[index(pick)].x() < 1;
  EXPECT_NEAR(static_cast<double>(left) / static_cast<double>(number_of_picks(truth)), 2.0 / 3, 0.04);
}

TEST(SimulatedGroundTruth, OfATetrahedronStopsAtFourPicks) {
  const Mesh mesh = shapes::tetrahedron();
  const GroundTruth truth = simulated_ground_truth(mesh, {}, 1, "tetrahedron");
  expect_sound(truth, mesh);
  EXPECT_THAT(truth.picks, Each(SizeIs(testing::Le(4U))));
  EXPECT_THAT(truth.picks, Contains(SizeIs(4U)));
}

// The mesh has two flat squares, each with room for one pick; the small one has a share p of the area. A
// participant picks twice, unless the next 64 draws fall on the square of the first pick, mostly the large
// one.
TEST(SimulatedGroundTruth, StopsAfterSixtyFourDrawsInARow) {
  constexpr double kShare = 1.0 / 40;
  Mesh mesh;
  for (const auto& [side, x] : {std::pair(1.0, 0.0), {std::sqrt(kShare / (1 - kShare)), 5.0}}) {
    const auto first = static_cast<std::int32_t>(mesh.vertices.size());
    for (const auto& [u, v] : {std::pair(0, 0), {1, 0}, {1, 1}, {0, 1}})
      mesh.vertices.emplace_back(x + side * u, side * v, 0);
    mesh.faces.push_back({first, first + 1, first + 2});
    mesh.faces.push_back({first, first + 2, first + 3});
  }
  const SimulationOptions options{.participants = 160'000, .picks = 9, .separation = 3};
  const GroundTruth truth = simulated_ground_truth(mesh, options, 1, "squares");
  const double expected = 1 - std::pow(1 - kShare, 65);
  const double share = static_cast<double>(number_of_picks(truth)) / options.participants - 1;
  EXPECT_NEAR(share, expected, 2.5 * std::sqrt(expected * (1 - expected) / options.participants));
}

TEST(SimulatedGroundTruth, NeverPicksAnIsolatedVertexOfAMesh) {
  Mesh mesh = shapes::tetrahedron();
  mesh.vertices.insert(mesh.vertices.begin(), Vec3(50, 0, 0));
  for (Triangle& face : mesh.faces)
    for (std::int32_t& vertex : face) ++vertex;
  mesh.vertices.emplace_back(-50, 0, 0);
  const GroundTruth truth = simulated_ground_truth(mesh, {}, 1, "isolated");
  expect_sound(truth, mesh);
  for (const auto& own : truth.picks) EXPECT_THAT(own, IsSubsetOf({1, 2, 3, 4}));
}

TEST(SimulatedGroundTruth, ReachesAllComponents) {
  const Mesh one = shapes::bumpy_sphere(3), mesh = shapes::joined(one, one, {5, 0, 0});
  const GroundTruth truth = simulated_ground_truth(mesh, {}, 1, "twins");
  expect_sound(truth, mesh);
  std::size_t second = 0;
  for (const auto& own : truth.picks)
    for (const std::int32_t pick : own) second += index(pick) >= one.vertices.size();
  EXPECT_NEAR(static_cast<double>(second) / static_cast<double>(number_of_picks(truth)), 0.5, 0.12);
}

TEST(SimulatedGroundTruth, WorksWithoutASurfaceButNotWithoutVertices) {
  for (const Mesh& mesh : {Mesh{shapes::random_cloud(40, 1), {}}, Mesh{{Vec3(1, 2, 3)}, {}},
                           Mesh{std::vector<Vec3>(3, Vec3(1, 2, 3)), {{0, 1, 2}}},
                           Mesh{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}}})
    expect_sound(simulated_ground_truth(mesh, {}, 1, "points"), mesh);
  EXPECT_THROW(simulated_ground_truth({}, {}, 1, "nothing"), InputError);
}

}  // namespace
}  // namespace salbench
