// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/lvj.h"

#include "stages/core/field.h"
#include "tests/stages/models/surfaces.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

ScalarField lvj(const Mesh& mesh, const LvjOptions& options = {}) {
  return lvj_saliency(mesh.vertices, mesh.faces, options);
}

double gaussian_mean(const std::vector<Vec3>& points, const ScalarField& values, std::size_t i,
                     double sigma) {
  double sum = 0, weights = 0;
  for (std::size_t j = 0; j < points.size(); ++j) {
    const double distance = (points[j] - points[i]).norm();
    if (distance > 2 * sigma) continue;
    const double weight = std::exp(-distance * distance / (2 * sigma * sigma));
    sum += weight * values[j];
    weights += weight;
  }
  return sum / weights;
}

// The paper's formulas over every pair of points.
ScalarField lvj_written_out(const Mesh& mesh, double epsilon) {
  const ScalarField curvature = mean_curvature(mesh.vertices, mesh.faces, CurvatureMethod::taubin);
  const Adjacency adjacency = edge_adjacency(mesh.vertices.size(), mesh.faces);
  Vec3 low = mesh.vertices[0], high = low;
  for (const Vec3& v : mesh.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  ScalarField saliency(mesh.vertices.size(), 0);
  for (const int scale : {2, 3, 4, 5, 6}) {
    const double sigma = scale * epsilon * (high - low).norm();
    ScalarField map;
    for (std::size_t i = 0; i < curvature.size(); ++i)
      map.push_back(std::abs(gaussian_mean(mesh.vertices, curvature, i, sigma) -
                             gaussian_mean(mesh.vertices, curvature, i, 2 * sigma)));
    const double smallest = *std::ranges::min_element(map), largest = *std::ranges::max_element(map);
    std::vector<double> peaks;
    for (double& value : map) value = (value - smallest) / (largest - smallest);
    for (std::size_t i = 0; i < map.size(); ++i) {
      double highest = 0, lowest = 1;  // among the neighbours
      for (const std::int32_t j : adjacency.of(i)) {
        highest = std::max(highest, map[index(j)]);
        lowest = std::min(lowest, map[index(j)]);
      }
      if (map[i] > highest - 1e-9 && map[i] > lowest + 1e-9) peaks.push_back(map[i]);
    }
    std::ranges::sort(peaks);
    peaks.pop_back();  // the global one
    double mean = 0;
    for (const double peak : peaks) mean += peak / static_cast<double>(peaks.size());
    for (std::size_t i = 0; i < map.size(); ++i) saliency[i] += (1 - mean) * (1 - mean) * map[i];
  }
  return saliency;
}

TEST(Lvj, EqualsTheFormulasWrittenOut) {
  for (const double epsilon : {0.003, 0.02})
    for (const Mesh& mesh : {shapes::bumpy_sphere(4), shapes::torus(2, 0.7, 61, 31)})
      EXPECT_THAT(lvj(mesh, {.epsilon = epsilon}),
                  Pointwise(DoubleNear(1e-9), lvj_written_out(mesh, epsilon)));
}

TEST(LvjSuppression, OnePeakCountsAndManyEqualOnesDoNot) {
  const Mesh grid = shapes::grid(6);
  const Adjacency adjacency = edge_adjacency(grid.vertices.size(), grid.faces);
  ScalarField map(grid.vertices.size(), 0);
  map[8] = 1;
  EXPECT_EQ(suppression(map, adjacency), 1);
  map[24] = 0.5;
  EXPECT_EQ(suppression(map, adjacency), 0.25);
  map[12] = 1;  // as large as the global one
  EXPECT_EQ(suppression(map, adjacency), 0.0625);
  map[25] = 0.5;  // two equal ones side by side
  EXPECT_DOUBLE_EQ(suppression(map, adjacency), 1.0 / 9);
}

TEST(Lvj, ALargeSurfaceIsSimplified) {
  const Mesh mesh = shapes::sphere_with_bump(5, 0.05, 0.1);
  const ScalarField all = lvj(mesh), coarse = lvj(mesh, {.faces = 10000});
  EXPECT_NE(all, coarse);
  const auto top = static_cast<std::size_t>(std::ranges::max_element(coarse) - coarse.begin());
  EXPECT_GT(mesh.vertices[top].normalized().z(), std::cos(0.3));
}

}  // namespace
}  // namespace salbench
