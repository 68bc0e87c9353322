// SPDX-License-Identifier: GPL-3.0-or-later
// Shuffled AUC, cosine, divergences by convention and the floor of maps: known answers. Random cases are in
// metrics_reference.py.
#include <cmath>
#include <limits>
#include <utility>

#include <gtest/gtest.h>

#include "stages/core/errors.h"
#include "stages/geometry/centre.h"
#include "stages/metrics/roc.h"
#include "tests/stages/metrics/complete.h"
#include "tests/support/shapes.h"

namespace salbench {
namespace {

double value(const std::string& metric, const ScalarField& map, const GroundTruth& truth, double floor = 0) {
  MetricsOptions options;
  options.names = {metric};
  options.floor = floor;
  const ScalarField areas(map.size(), 0.5);
  return complete_score(chosen_metrics(options), map, truth, options, areas, areas).values[0];
}

TEST(ShuffledAuc, IsUndefinedWithoutNegativesOrPicks) {
  const ScalarField map = {0, 1, 2};
  const std::vector<std::int32_t> picked = {1};
  EXPECT_TRUE(std::isnan(shuffled_auc(map, picked, {}, vertex_measure(3))));
  EXPECT_TRUE(std::isnan(shuffled_auc(map, picked, ScalarField(3, 0.0), vertex_measure(3))));
  EXPECT_TRUE(std::isnan(shuffled_auc(map, {}, ScalarField(3, 1.0), vertex_measure(3))));
}

TEST(MarksOf, ReadTheOneThatComesFirstOrElseTheOther) {
  const ScalarField saliency = {3, 0, 1};
  const auto marks = [](const GroundTruth& truth) {
    return std::pair(marks_of(truth, 3, MarksFrom::saliency_first),
                     marks_of(truth, 3, MarksFrom::picks_first));
  };
  const ScalarField picks = {0, 2, 1};
  EXPECT_EQ(marks({saliency, {{1, 2}, {1}}}), std::pair(saliency, picks));
  EXPECT_EQ(marks({saliency, {{}}}), std::pair(saliency, saliency));
  EXPECT_EQ(marks({{}, {{1, 2}, {1}}}), std::pair(picks, picks));
  const ScalarField masked = marks({{3, std::nan(""), 1}, {{1, 2}}}).second;
  EXPECT_TRUE(masked[0] == 0 && std::isnan(masked[1]) && masked[2] == 1) << "nobody saw the second point";
}

TEST(CentreDensity, OfTheOthersLeavesThisShapeOut) {
  const std::vector<Vec3> points = {{1, 0, 0}, {-1, 0, 0}, {0, 0.5, 0}, {0, -0.5, 0}};
  const GroundTruth outside{{3, 1, 0, 0}, {}}, even{{1, 1, 1, 1}, {}}, picked{{}, {{2}, {2, 0}}};
  const CentreDensity first = centre_density(points, outside), second = centre_density(points, even),
                      third = centre_density(points, picked);
  EXPECT_EQ(first.marked[99], 1);
  EXPECT_EQ(first.points[99], 0.5);
  EXPECT_EQ(third.marked[50], 2.0 / 3);
  CentreDensity set;
  for (const CentreDensity* shape : {&first, &second, &third}) add(set, *shape);
  const ScalarField of_others = density_of_others(points, first, set);
  EXPECT_NEAR(of_others[0], (0.5 + 1.0 / 3) / 1, 1e-15);
  EXPECT_NEAR(of_others[2], (0.5 + 2.0 / 3) / 1, 1e-15);
  EXPECT_EQ(of_others[1], of_others[0]);
  CentreDensity alone;
  add(alone, first);
  EXPECT_TRUE(density_of_others(points, first, alone).empty());
}

TEST(CentreDensity, IsZeroWhereNoOtherShapeHasPoints) {
  const std::vector<Vec3> square = {{1, 0, 0}, {-1, 0, 0}, {0, 0.5, 0}, {0, -0.5, 0}},
                          ring = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
  const CentreDensity own = centre_density(square, {{1, 1, 1, 1}, {}}),
                      other = centre_density(ring, {{1, 2, 3, 4}, {}});
  CentreDensity set;
  add(set, other);
  add(set, own);
  EXPECT_EQ(density_of_others(square, own, set), (ScalarField{1, 1, 0, 0}));
}

TEST(CentreDensity, SaysNothingWhereTheGroundTruthDoesNot) {
  const std::vector<Vec3> points = {{1, 0, 0}, {-1, 0, 0}, {0, 0.5, 0}};
  const double unseen = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  for (const ScalarField& saliency : {ScalarField{0, 0, 0}, ScalarField{1, -1, 2},
                                      ScalarField{1, infinity, 2}, ScalarField{unseen, unseen, unseen}})
    EXPECT_EQ(centre_density(points, {saliency, {}}).shapes, 0);
  EXPECT_EQ(centre_density(points, {{}, {{}}}).shapes, 0);
  const CentreDensity masked = centre_density(points, {{unseen, 1, 3}, {}});
  EXPECT_EQ(masked.points[masked.points.size() - 1] + masked.points[0] + masked.points[50],
            masked.shapes == 1 ? 0.5 : -1);
  const CentreDensity huge = centre_density(points, {ScalarField(3, 1.7e308), {}});
  EXPECT_EQ(huge.shapes, 1);
  EXPECT_THROW(centre_density(points, {{1, 2}, {}}), InputError);
  EXPECT_THROW(centre_density(std::vector<Vec3>(3, Vec3(1, 1, 1)), {{1, 2, 3}, {}}), InputError);
}

TEST(Cosine, IsThatOfTheAngle) {
  EXPECT_DOUBLE_EQ(value("cosine", {0, 1}, {{2, 2}, {}}), std::sqrt(0.5));
  EXPECT_DOUBLE_EQ(value("cosine", {0, 0.5, 1}, {{0, -1, -2}, {}}), -1);
  EXPECT_DOUBLE_EQ(value("cosine_area", {0, 1}, {{1e-200, 1e-200}, {}}), std::sqrt(0.5));
  EXPECT_DOUBLE_EQ(value("cosine", {7, 7, 7}, {{1, 0, 0}, {}}), 1 / std::sqrt(3));
  EXPECT_TRUE(std::isnan(value("cosine", {0, 1, 1}, {{0, 0, 0}, {}})));
  EXPECT_TRUE(std::isnan(value("cosine", {0, 1, 1}, {{}, {{1}}})));
}

// A ground truth where the map is 0: what the floor costs is all that there is.
TEST(Divergence, OfDisjointFieldsIsThatOfItsFloor) {
  const ScalarField map = {1, 0};
  const GroundTruth truth{{0, 1}, {}};
  EXPECT_NEAR(value("kl_keras", map, truth), std::log(1e7), 1e-6);
  EXPECT_NEAR(value("kl_caffe", map, truth), std::log(1e6), 1e-5);
  EXPECT_NEAR(value("kl_pysaliency", map, truth), std::log(1e20), 1e-9);
  EXPECT_NEAR(value("kl_shifted", map, truth), std::log(1e12), 1e-9);
  EXPECT_NEAR(value("kl_keras_area", map, truth), std::log(2e7), 1e-6)
      << "densities are twice the uniform one";
  for (const char* name : {"kl_keras", "kl_caffe", "kl_pysaliency", "kl_shifted"}) {
    EXPECT_TRUE(std::isnan(value(name, map, {{0, 0}, {}}))) << name;
    EXPECT_TRUE(std::isnan(value(name, map, {{-1, 1}, {}}))) << name;
    EXPECT_NEAR(value(name, {4, 4}, {{1, 1}, {}}), 0, 1e-5) << name;
  }
}

TEST(Floor, RaisesMapsThatAreReadAsDensities) {
  const ScalarField map = {0, 0.02, 1};
  const GroundTruth truth{{1, 1, 2}, {{0}}};
  const double sum = 0.05 + 0.05 + 1;
  EXPECT_NEAR(value("sim", map, truth, 0.05), 0.05 / sum + 0.05 / sum + 0.5, 1e-12);
  EXPECT_NEAR(value("kl", map, truth, 0.05),
              2 * 0.25 * std::log(0.25 / (0.05 / sum)) + 0.5 * std::log(0.5 / (1 / sum)), 1e-12);
  EXPECT_NEAR(value("ig", map, truth, 0.05), std::log2(3 * 0.05 / sum), 1e-12);
  for (const Metric& metric : metric_table()) {
    const std::string name = metric.name.substr(0, metric.name.find('_'));
    const double without = value(metric.name, map, truth), with = value(metric.name, map, truth, 0.05);
    if (name == "kl" || name == "sim" || name == "ig")
      EXPECT_GT(std::abs(with - without), 1e-3) << metric.name;
    else
      EXPECT_TRUE(with == without || (std::isnan(with) && std::isnan(without))) << metric.name;
  }
  EXPECT_NEAR(value("sim", map, truth, 1), 0.25 + 0.25 + 1.0 / 3, 1e-12) << "the uniform distribution";
}

}  // namespace
}  // namespace salbench
