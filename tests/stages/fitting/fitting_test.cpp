// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/fitting/fitting.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

#include "stages/core/errors.h"
#include "stages/geometry/centre.h"
#include "stages/geometry/laplacian.h"
#include "stages/geometry/mesh_ops.h"
#include "tests/support/shapes.h"

namespace salbench {
namespace {

const Mesh kGrid = shapes::grid(30);
const Adjacency kEdges = edge_adjacency(kGrid.vertices.size(), kGrid.faces);

ScalarField noise(const std::string& name) {
  Rng rng(1, "noise", name);
  ScalarField values(kGrid.vertices.size());
  for (double& value : values) value = rng.uniform();
  values[0] = 0;
  values[1] = 1;
  return values;
}

struct Set {
  std::vector<ScalarField> maps;
  std::vector<GroundTruth> truths;
  std::vector<std::shared_ptr<const DensityCounts>> counts;

  void add(ScalarField map, GroundTruth truth, std::int32_t fold) {
    counts.push_back(
        std::make_shared<const DensityCounts>(density_counts(map, kGrid.vertices, kEdges, truth, fold)));
    maps.push_back(std::move(map));
    truths.push_back(std::move(truth));
  }
};

// 20 maps of noise in 5 folds, with a ground truth that follows from each.
Set set_of(const std::function<ScalarField(const ScalarField&)>& truth_of) {
  Set set;
  for (int k = 0; k < 20; ++k) {
    ScalarField map = noise(std::to_string(k));
    GroundTruth truth{truth_of(map), {}};
    set.add(std::move(map), std::move(truth), k % 5);
  }
  return set;
}

ScalarField applied(const ScalarField& values, double (*function)(double)) {
  ScalarField result;
  for (const double value : values) result.push_back(function(value));
  return result;
}

// Mean of the logarithm of the density, in bits over the uniform one, by what people marked.
double gain(const ScalarField& density, const ScalarField& marks) {
  const double sum = std::reduce(density.begin(), density.end()),
               marked = std::reduce(marks.begin(), marks.end());
  double gain = 0;
  for (std::size_t i = 0; i < marks.size(); ++i)
    gain += marks[i] / marked * std::log2(density[i] / sum * static_cast<double>(density.size()));
  return gain;
}
double held_out_gain(const Set& set, const DensityFits& fits) {
  double sum = 0;
  for (std::size_t k = 0; k < set.maps.size(); ++k)
    sum += gain(fitted_density(set.maps[k], kGrid.vertices, kEdges, fits[index(set.counts[k]->fold)]),
                set.truths[k].saliency);
  return sum / static_cast<double>(set.maps.size());
}

// Fits of maps, of noise and of blurred maps beside SciPy's: tests/pipeline/fitted_twin_test.py.
TEST(Fitting, RecoversAMonotoneFunctionOfTheMap) {
  for (double (*function)(double) :
       {+[](double v) { return std::exp(3 * v); }, +[](double v) { return 0.1 + v * v; }}) {
    const Set set = set_of([&](const ScalarField& map) { return applied(map, function); });
    const DensityFits fits = fit_densities(set.counts, 5);
    double best = 0;
    for (std::size_t k = 0; k < set.maps.size(); ++k)
      best += gain(set.truths[k].saliency, set.truths[k].saliency) / 20;
    EXPECT_NEAR(held_out_gain(set, fits), best, 0.02 * best);
    for (const DensityFit& fit : fits) {
      EXPECT_EQ(fit.shapes, 16);
      EXPECT_EQ(fit.blur, 0);
      EXPECT_NEAR(fit.gain, best, 0.02 * best);
      EXPECT_NEAR(fit.value[15] - fit.value[5], std::log(function(15.0 / 19) / function(5.0 / 19)), 0.1);
    }
  }
}

TEST(Fitting, FindsTheCentreBiasOfAConstantMap) {
  const ScalarField distances = distances_from_centroid(kGrid.vertices);
  Set set;
  for (int k = 0; k < 10; ++k)
    set.add(ScalarField(distances.size(), 7),
            {applied(distances, [](double d) { return std::exp(-4 * d); }), {}}, k % 2);
  const DensityFit fit = fit_densities(set.counts, 2)[0];
  EXPECT_NEAR(fit.distance[8] - fit.distance[2], -4 * 6 / 9.0, 0.1);
  EXPECT_NEAR(held_out_gain(set, {fit, fit}), gain(set.truths[0].saliency, set.truths[0].saliency), 0.01);
}

TEST(Fitting, TakesAllConstantMapsForTheSameHoweverTheyAreBlurred) {
  const GroundTruth truth{noise("truth"), {}};
  const auto counts = [&](double value) {
    return density_counts(ScalarField(kGrid.vertices.size(), value), kGrid.vertices, kEdges, truth, 0);
  };
  const DensityCounts middle = counts(0.5);
  for (const double value : {-3.0, 0.0, 0.1, 7.0}) {
    EXPECT_EQ(counts(value).cells, middle.cells) << value;
    EXPECT_EQ(counts(value).marked, middle.marked) << value;
  }
  const std::size_t in_one_blur = middle.cells.size() / kBlurWidths.size();
  for (std::size_t k = in_one_blur; k < middle.cells.size(); ++k)
    EXPECT_EQ(middle.points[k], middle.points[k - in_one_blur]);
  DensityFit fit{.shapes = 1, .blur = 0.08};
  for (std::size_t k = 0; k < kValueKnots; ++k) fit.value[k] = static_cast<double>(k);
  const ScalarField density =
      fitted_density(ScalarField(kGrid.vertices.size(), -3), kGrid.vertices, kEdges, fit);
  EXPECT_EQ(density, ScalarField(kGrid.vertices.size(), 1));
}

TEST(Fitting, BlursAsFarHoweverManyPointsHaveNoEdges) {
  DensityFit fit{.shapes = 1, .blur = 0.08};
  std::iota(fit.value.begin(), fit.value.end(), 0.0);
  ScalarField map = noise("map");
  const ScalarField expected = fitted_density(map, kGrid.vertices, kEdges, fit);
  Mesh mesh = kGrid;  // and three times its points again: centroid and R stay
  for (std::size_t i = 0; i < 3 * kGrid.vertices.size(); ++i) {
    mesh.vertices.push_back(kGrid.vertices[i % kGrid.vertices.size()]);
    map.push_back(0.5);
  }
  const ScalarField density =
      fitted_density(map, mesh.vertices, edge_adjacency(mesh.vertices.size(), mesh.faces), fit);
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(density[i], expected[i], 1e-9) << i;
}

// Edges a millionth as long as the shape is wide: a step for each would be 1e9 of them.
TEST(Fitting, EndsWhereAFewFacesAreTiny) {
  std::vector<Vec3> points = shapes::random_cloud(3000, 4);
  for (std::size_t i = 0; i < 30; ++i) points[i] = points[0] + 1e-6 * points[i];
  Faces faces;
  for (std::int32_t i = 0; i + 2 < 30; i += 3) faces.push_back({i, i + 1, i + 2});
  const Adjacency edges = edge_adjacency(points.size(), faces);
  ScalarField map;
  for (const Vec3& p : points) map.push_back(p.x());
  const DensityCounts counts = density_counts(map, points, edges, {{}, {{7}}}, 0);
  EXPECT_NEAR(std::reduce(counts.points.begin(), counts.points.end()), kBlurWidths.size(), 1e-5);
}

TEST(Fitting, LeavesOutTheShapesOfTheFoldItself) {
  Set set = set_of([](const ScalarField& map) { return applied(map, [](double v) { return std::exp(v); }); });
  const DensityFits before = fit_densities(set.counts, 5);
  for (std::size_t k = 0; k < 20; k += 5)
    set.counts[k] = std::make_shared<const DensityCounts>(
        density_counts(set.maps[k], kGrid.vertices, kEdges, {noise("other"), {}}, 0));
  const DensityFits after = fit_densities(set.counts, 5);
  EXPECT_EQ(before[0].value, after[0].value);
  EXPECT_NE(before[1].value, after[1].value);
}

TEST(Fitting, IsNothingWithoutOtherShapes) {
  Set set;
  set.add(noise("a"), {noise("b"), {}}, 1);
  set.add(noise("c"), {ScalarField(kGrid.vertices.size()), {}}, 0);  // says nothing
  const DensityFits fits = fit_densities(set.counts, 2);
  EXPECT_EQ(fits[1].shapes, 0);
  EXPECT_EQ(fits[0].shapes, 1);
  EXPECT_TRUE(fitted_density(set.maps[0], kGrid.vertices, kEdges, fits[1]).empty());
}

TEST(Fitting, CountsPicksAndPointsThatWereSeen) {
  GroundTruth truth{noise("saliency"), {{3, 4}, {4, 4}}};
  const ScalarField map = noise("map");
  const DensityCounts counts = density_counts(map, kGrid.vertices, kEdges, truth, 2);
  EXPECT_EQ(counts.fold, 2);
  EXPECT_EQ(*std::ranges::max_element(counts.marked), 0.75F);
  EXPECT_NEAR(std::reduce(counts.points.begin(), counts.points.end()), kBlurWidths.size(), 1e-5);
  truth.saliency[4] = std::nan("");
  const DensityCounts without = density_counts(map, kGrid.vertices, kEdges, truth, 2);
  EXPECT_EQ(*std::ranges::max_element(without.marked), 1);
}

TEST(Fitting, NamesWhatCannotBeRead) {
  const auto counts = [](const ScalarField& map, const GroundTruth& truth) {
    return density_counts(map, kGrid.vertices, kEdges, truth, 0);
  };
  ScalarField map = noise("map");
  EXPECT_THROW(counts(map, {{}, {{-1}}}), InputError);
  EXPECT_THROW(counts(map, {{}, {{31 * 31}}}), InputError);
  EXPECT_THROW(counts(map, {{1, 2}, {}}), InputError);
  map[3] = std::numeric_limits<double>::infinity();
  EXPECT_THROW(counts(map, {noise("truth"), {}}), InputError);
}

TEST(Fold, DependsOnGroupAndSeedAlone) {
  std::vector<int> sizes(10);
  for (int k = 0; k < 1000; ++k) ++sizes[index(fold_of("mesh " + std::to_string(k), 10, 2016))];
  for (const int size : sizes) EXPECT_NEAR(size, 100, 40);
  EXPECT_EQ(fold_of("class ant", 10, 1), fold_of("class ant", 10, 1));
}

}  // namespace
}  // namespace salbench
