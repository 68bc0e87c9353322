// SPDX-License-Identifier: GPL-3.0-or-later
// Local maxima of a map, and errors of interest points, with known answers. Random cases against other
// implementations are in interest_reference.py.
#include "stages/metrics/interest_points.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/core/errors.h"
#include "tests/stages/metrics/complete.h"
#include "tests/support/shapes.h"

namespace salbench {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// Points 1 apart on a line, each joined to the next by a face without area.
SurfaceGraph line(std::int32_t n) {
  std::vector<Vec3> points;
  Faces faces;
  for (std::int32_t i = 0; i < n; ++i) {
    points.push_back({static_cast<double>(i), 0, 0});
    if (i > 0) faces.push_back({i - 1, i, i});
  }
  return surface_graph(points, faces);
}

TEST(LocalMaxima, RiseAboveAllTheirNeighbours) {
  const SurfaceGraph graph = line(7);
  EXPECT_THAT(local_maxima(ScalarField{1, 0, 0.5, 0.2, 0.2, 0.3, 0.1}, graph, {.height = 0}),
              ElementsAre(0, 2, 5));
  EXPECT_THAT(local_maxima(ScalarField{0, 0.1, 0.2, 0.3, 0.4, 0.5, 1}, graph, {}), ElementsAre(6));
}

TEST(LocalMaxima, OfAPlateauAreItsFirstPoint) {
  const SurfaceGraph graph = line(7);
  EXPECT_THAT(local_maxima(ScalarField{0, 1, 1, 1, 0, 1, 1}, graph, {}), ElementsAre(1, 5));
  EXPECT_THAT(local_maxima(ScalarField{0, 0.5, 0.5, 1, 0, 0, 0}, graph, {}), ElementsAre(3))
      << "a terrace is none";
  const SurfaceGraph grid = surface_graph(shapes::grid(4).vertices, shapes::grid(4).faces);
  ScalarField ring(25, 0.0);
  for (const std::size_t i : {6U, 7U, 8U, 11U, 13U, 16U, 17U, 18U}) ring[i] = 1;
  EXPECT_THAT(local_maxima(ring, grid, {}), ElementsAre(6));
}

TEST(LocalMaxima, AreNowhereOnAConstantMapOrOnLoosePoints) {
  EXPECT_THAT(local_maxima(ScalarField(7, 0.5), line(7), {}), IsEmpty());
  const SurfaceGraph loose =
      surface_graph(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {9, 9, 9}}, Faces{{0, 1, 1}});
  EXPECT_THAT(local_maxima(ScalarField{0, 0.1, 1}, loose, {}), ElementsAre(1));
}

TEST(LocalMaxima, WithinARadiusAreTheHighestAndOfEqualOnesTheFirst) {
  const SurfaceGraph graph = line(9);  // R is 4
  const ScalarField map = {0, 0.8, 0, 1, 0, 1, 0, 0, 0.4};
  EXPECT_THAT(local_maxima(map, graph, {.radius = 0.4, .height = 0}), ElementsAre(1, 3, 5, 8));
  EXPECT_THAT(local_maxima(map, graph, {.radius = 0.5, .height = 0}), ElementsAre(3, 8));
  EXPECT_THAT(local_maxima(map, graph, {.radius = 1, .height = 0}), ElementsAre(3));
}

TEST(LocalMaxima, AreAsHighAsTheirMean) {
  const ScalarField map = {0, 1, 0, 0.5, 0, 0.4, 0};
  EXPECT_THAT(local_maxima(map, line(7), {}), ElementsAre(1));
  EXPECT_THAT(local_maxima(map, line(7), {.height = 0.75}), ElementsAre(1, 3)) << "the mean is 0.633";
  ScalarField equal(601, 0.0);
  for (std::size_t i = 1; i < 601; i += 2) equal[i] = 0.1;  // a sum that is rounded
  EXPECT_EQ(local_maxima(equal, line(601), {}).size(), 300U);
}

TEST(InterestPointScores, AreSharesOfPointsByHand) {
  const std::vector<std::int32_t> marked = {2, 2, 2, 10, 20}, detected = {1, 3, 15};
  const InterestPointScores scores = interest_point_scores(detected, marked, line(31), 0.04);  // 1.2 of 30
  EXPECT_DOUBLE_EQ(scores.fne, 2.0 / 3);
  EXPECT_DOUBLE_EQ(scores.fpe, 1 - 1.0 / 3)
      << "points 1 and 3 are at the same marked point, which counts once";
  EXPECT_DOUBLE_EQ(scores.wme, 1 - 3.0 / 5);
  EXPECT_DOUBLE_EQ(scores.precision, 2.0 / 3);
  EXPECT_DOUBLE_EQ(scores.recall, 1.0 / 3);
}

TEST(InterestPointScores, ADetectedPointCountsForTheNearestMarkedOneAlone) {
  const std::vector<std::int32_t> marked = {4, 9};
  const auto scores = [&](std::int32_t detected) {
    return interest_point_scores(std::vector{detected}, marked, line(11), 0.5);
  };
  EXPECT_EQ(scores(6).fne, 0.5);
  EXPECT_EQ(scores(6).recall, 1) << "both lie within the tolerance";
  EXPECT_EQ(scores(6).fpe, 0);
  EXPECT_EQ(interest_point_scores(std::vector{5, 6}, marked, line(11), 0.5).fne, 0.5);
  EXPECT_EQ(interest_point_scores(std::vector{5, 8}, marked, line(11), 0.5).fne, 0);
}

TEST(InterestPointScores, AtEqualDistanceTheFirstMarkedPointHasIt) {
  const std::vector<std::int32_t> marked = {4, 4, 8}, detected = {6};
  const InterestPointScores scores = interest_point_scores(detected, marked, line(11), 0.5);
  EXPECT_EQ(scores.fne, 0.5);
  EXPECT_DOUBLE_EQ(scores.wme, 1.0 / 3);
  EXPECT_EQ(scores.fpe, 0);
}

TEST(InterestPointScores, MeasureAlongTheSurface) {
  // The ends of a horseshoe nearly touch.
  std::vector<Vec3> points;
  Faces faces;
  for (std::int32_t i = 0; i < 60; ++i) {
    points.push_back({std::cos(i / 10.0), std::sin(i / 10.0), 0});
    if (i > 0) faces.push_back({i - 1, i, i});
  }
  const SurfaceGraph graph = surface_graph(points, faces);
  ASSERT_LT((points[0] - points[59]).norm(), 0.4);
  EXPECT_EQ(interest_point_scores(std::vector{59}, std::vector{0}, graph, 0.5).fne, 1);
  EXPECT_EQ(interest_point_scores(std::vector{9}, std::vector{0}, graph, 0.5).fne, 0);
}

TEST(InterestPointScores, OfNothingDetectedMissEverything) {
  const InterestPointScores scores = interest_point_scores({}, std::vector{1, 3}, line(5), 0.5);
  EXPECT_EQ(scores.fne, 1);
  EXPECT_EQ(scores.wme, 1);
  EXPECT_EQ(scores.recall, 0);
  EXPECT_EQ(scores.fpe, 1) << "a map that says nothing is no good detector";
  EXPECT_EQ(scores.precision, 0);
  const InterestPointScores unmarked = interest_point_scores(std::vector{1}, {}, line(5), 0.5);
  for (const double value : {unmarked.fne, unmarked.fpe, unmarked.wme, unmarked.precision, unmarked.recall})
    EXPECT_TRUE(std::isnan(value));
}

TEST(InterestPoints, OfAMaskedShapeArePointsThatWereSeen) {
  Measures measures(9, {});
  measures.surface = std::make_shared<const SurfaceGraph>(line(9));
  MetricsOptions options;
  options.names = {"fne", "recall"};
  options.tolerance = 0.5;
  GroundTruth truth{ScalarField(9, 1.0), {{1, 6}}};
  truth.saliency[0] = 2;
  const ScalarField map = {0, 0, 0, 0, 0, 0.9, 1, 0.5, 0};
  const auto recall = [&] {
    const Rng draws(1, "", "");
    return score(chosen_metrics(options), map, truth, options, draws, measures).values[1];
  };
  options.tolerance = 0.65;  // 5.2
  EXPECT_EQ(recall(), 1);
  truth.saliency[3] = std::nan("");
  EXPECT_EQ(recall(), 0.5) << "no path leads through a point that nobody saw";
  truth.saliency[6] = std::nan("");
  EXPECT_EQ(recall(), 0) << "point 5 is the highest now, point 1 the only one marked";
}

TEST(SurfaceGraph, DiameterIsTheLargestDistance) {
  Rng rng(3, "diameter", "");
  for (int k = 0; k < 200; ++k) {
    std::vector<Vec3> points(1 + rng.below(40));
    for (Vec3& p : points) p = {rng.uniform(), rng.uniform() * (k % 3), rng.uniform() * (k % 5)};
    double largest = 0;
    for (const Vec3& a : points)
      for (const Vec3& b : points) largest = std::max(largest, (a - b).norm());
    EXPECT_EQ(diameter_of(points), largest);
  }
  EXPECT_NEAR(diameter_of(shapes::sphere(3).vertices), 2, 1e-12);
  EXPECT_EQ(diameter_of(std::vector<Vec3>(100, Vec3(1, 2, 3))), 0);
  EXPECT_EQ(diameter_of({}), 0);
}

TEST(SurfaceGraph, OfSomePointsHasTheEdgesBetweenThem) {
  const SurfaceGraph graph = strip(10), some = graph.at(std::vector<std::int32_t>{1, 2, 4, 9});
  EXPECT_THAT(some.edges.offsets, ElementsAre(0, 1, 3, 4, 4));
  EXPECT_THAT(some.edges.neighbours, ElementsAre(1, 0, 2, 1));
  EXPECT_EQ(some.points[3], graph.points[9]);
  EXPECT_EQ(some.diameter, graph.diameter);
  EXPECT_THROW(surface_graph(graph.points, Faces{{0, 1, 10}}), InputError);
}

TEST(NearestSources, AreThoseOfSearchesFromEach) {
  Rng rng(4, "nearest", "");
  const Mesh mesh = shapes::bumpy_sphere(3);
  const SurfaceGraph graph = surface_graph(mesh.vertices, mesh.faces);
  EdgeDistances distances(graph.points, graph.edges);
  for (int k = 0; k < 20; ++k) {
    std::vector<std::int32_t> sources(1 + rng.below(20));
    for (std::int32_t& source : sources) source = static_cast<std::int32_t>(rng.below(mesh.vertices.size()));
    const double reach = rng.uniform();
    std::vector<NearestSource> expected(mesh.vertices.size());
    for (std::size_t s = 0; s < sources.size(); ++s)
      for (const ReachedPoint& reached : distances.from(sources[s], reach))
        if (reached.distance < expected[index(reached.index)].distance)
          expected[index(reached.index)] = {static_cast<std::int32_t>(s), reached.distance};
    const auto found = nearest_sources(graph, sources, reach);
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].source, expected[i].source);
      EXPECT_EQ(found[i].distance, expected[i].distance);
    }
  }
}

}  // namespace
}  // namespace salbench
