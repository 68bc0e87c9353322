// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/geometry/laplacian.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/core/errors.h"
#include "stages/metrics/metrics.h"
#include "tests/support/shapes.h"

namespace salbench {
namespace {

using testing::DoubleNear;
using testing::Each;
using testing::ElementsAre;

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

TEST(Smoothing, InManyStepsIsThatOneByOne) {
  Mesh mesh = shapes::bumpy_sphere(2);
  mesh.vertices.emplace_back(9, 9, 9);  // without edges
  const Adjacency edges = edge_adjacency(mesh.vertices.size(), mesh.faces);
  ScalarField map(mesh.vertices.size(), 0);
  map[3] = map.back() = 1;
  for (const std::int32_t steps : {1, 2, 3, 4, 7, 100, 101, 1000, 20001}) {
    const ScalarField expected = smoothed_by_steps(map, edges, steps);
    const ScalarField found = smoothed_by_many_steps(map, edges, steps);
    for (std::size_t i = 0; i < map.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-13) << steps;
  }
}

TEST(Smoothing, EndsInAConstant) {
  const Mesh mesh = shapes::sphere(1);
  ScalarField map(mesh.vertices.size(), 0.0);
  map[3] = 1e300;
  const ScalarField smooth = smoothed_by_steps(map, edge_adjacency(map.size(), mesh.faces), 2000);
  EXPECT_THAT(smooth, Each(DoubleNear(smooth[0], 1e-9 * smooth[0])));
  EXPECT_GT(smooth[0], 0);
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
