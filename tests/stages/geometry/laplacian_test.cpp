// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/geometry/laplacian.h"

#include "stages/metrics/options.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

TEST(Smoothing, TakesTheMeanOverAPointAndItsNeighbours) {
  const Adjacency adjacency = edge_adjacency(5, std::vector<Triangle>{{0, 1, 2}, {1, 3, 2}});
  EXPECT_THAT(smoothed_by_steps({3, 0, 0, 8, 7}, adjacency, 1),
              ElementsAre(DoubleNear(1, 1e-15), DoubleNear(2.75, 1e-15), DoubleNear(2.75, 1e-15),
                          DoubleNear(8.0 / 3, 1e-15), 7));
  EXPECT_THAT(smoothed_by_steps({3, 0, 0, 8, 7}, adjacency, 0), ElementsAre(3, 0, 0, 8, 7));
}

TEST(Smoothing, InSeveralGoesIsThatInOne) {
  const Mesh mesh = shapes::bumpy_sphere(2);
  const Adjacency adjacency = edge_adjacency(mesh.vertices.size(), mesh.faces);
  ScalarField map;
  for (const Vec3& v : mesh.vertices) map.push_back(v.x() * v.y());
  EXPECT_EQ(smoothed_by_steps(smoothed_by_steps(map, adjacency, 3), adjacency, 7),
            smoothed_by_steps(map, adjacency, 10));
}

TEST(SmoothingSteps, AreAscendingWholeNumbers) {
  const auto steps = [](std::vector<std::string> words) {
    return smoothing_steps(MetricsOptions{.smoothing = std::move(words)});
  };
  EXPECT_THAT(steps({"0", "10", "120"}), ElementsAre(0, 10, 120));
  for (const auto& wrong : std::vector<std::vector<std::string>>{
           {"-1"}, {"1.5"}, {"x"}, {""}, {"10", "10"}, {"10", "0"}, {"100001"}, {"99999999999"}})
    EXPECT_THROW(steps(wrong), OptionError) << wrong.back();
}

}  // namespace
}  // namespace salbench
