// SPDX-License-Identifier: GPL-3.0-or-later
// Ties and rounding in local maxima and interest-point errors, and unseen points. Random cases against other
// implementations are in interest_reference.py.
#include "stages/metrics/interest_points.h"

#include "tests/stages/metrics/complete.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

// Points with spacing 1 on a line, each connected to the next by a face without area.
SurfaceGraph line(std::int32_t n) {
  std::vector<Vec3> points;
  Faces faces;
  for (std::int32_t i = 0; i < n; ++i) {
    points.push_back({static_cast<double>(i), 0, 0});
    if (i > 0) faces.push_back({i - 1, i, i});
  }
  return surface_graph(points, faces);
}

TEST(LocalMaxima, OfEqualHeightAreAsHighAsTheirMean) {
  ScalarField equal(601, 0.0);
  for (std::size_t i = 1; i < 601; i += 2) equal[i] = 0.1;  // a sum with rounding errors
  EXPECT_EQ(local_maxima(equal, line(601), {}).size(), 300U);
}

TEST(InterestPointScores, AtEqualDistanceTheFirstMarkedPointHasIt) {
  const std::vector<std::int32_t> marked = {4, 4, 8}, detected = {6};
  const InterestPointScores scores = interest_point_scores(detected, marked, line(11), 0.5);
  EXPECT_EQ(scores.fne, 0.5);
  EXPECT_DOUBLE_EQ(scores.wme, 1.0 / 3);
  EXPECT_EQ(scores.fpe, 0);
}

TEST(InterestPoints, OfAMaskedShapeArePointsThatWereSeen) {
  const Measures measures{.size = 9, .surface = std::make_shared<const SurfaceGraph>(line(9))};
  const MetricsOptions options{.names = {"fne"}, .tolerance = 0.65};  // 5.2
  GroundTruth truth{ScalarField(9, 1.0), {{1}}};
  truth.saliency[0] = 2;
  const ScalarField map = {0, 0, 0, 0, 0, 0.9, 1, 0.5, 0};
  const auto fne = [&] {
    const Rng draws(1, "", "");
    return score(chosen_metrics(options), map, truth, options, draws, measures).values[0];
  };
  EXPECT_EQ(fne(), 0);
  truth.saliency[3] = std::nan("");
  EXPECT_EQ(fne(), 1) << "no path leads through a point that nobody saw";
  truth.picks = {{1, 5, 6}};
  truth.saliency[6] = std::nan("");
  EXPECT_EQ(fne(), 0.5) << "point 5 is the highest now, points 1 and 5 are marked";
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
