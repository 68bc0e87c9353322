// SPDX-License-Identifier: GPL-3.0-or-later
// Scores of smoothed maps are additional, and change no others.

#include "pipeline/results/tables.h"
#include "stages/core/field.h"
#include "stages/geometry/laplacian.h"
#include "stages/matching/matching.h"
#include "stages/metrics/by_matching.h"
#include "stages/metrics/score.h"
#include "tests/pipeline/runner_fixture.h"
#include "tests/support/cloud_text.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

const std::string kSmoothing =
    std::string(kToyConfig) + "metrics: {names: [auc_exact, cc, kl, cc_area], smoothing: [0, 3, 10]}\n";

TEST_F(RunnerTest, SmoothedMapsAreScoredBesideTheOthers) {
  const std::string plain = std::string(kToyConfig) + "metrics: {names: [auc_exact, cc, kl, cc_area]}\n";
  run(plain);
  const std::string before = results();
  const auto computed = run(kSmoothing);
  EXPECT_EQ(results(), before);
  EXPECT_THAT(computed, Each(AnyOf(HasSubstr("smoothed_scores."), HasSubstr("smoothed_table."))));
  EXPECT_THAT(computed, SizeIs(JobCounts(kSmoothing).where([](const Rule& rule) {
                return has_role(rule, Role::smoothed_scores) || has_role(rule, Role::smoothed_table);
              })));
  EXPECT_THAT(run(kSmoothing), IsEmpty());
  EXPECT_THAT(run(plain), IsEmpty());
}

TEST_F(RunnerTest, SmoothedScoresAreThoseOfTheSmoothedMaps) {
  run(kSmoothing);
  const std::vector<ResultRow> rows = toy_->results();
  const Table table = smoothed_table(toy_->state(), metrics());
  EXPECT_THAT(std::vector(table.columns.begin(), table.columns.begin() + 3),
              ElementsAre("smoothing", "dataset", "item"));
  ASSERT_THAT(table.rows, SizeIs(3 * rows.size()));
  EXPECT_EQ(table.rows[rows.size()][0], Cell("3"));
  EXPECT_EQ(std::vector(table.rows[0].begin() + 1, table.rows[0].end()),
            results_table(rows, metrics()).rows[0]);
  EXPECT_EQ(table.rows[rows.size()][2], Cell(rows[0].item));
  const auto mesh = toy_->value<Mesh>("mesh", mesh_unit(0));
  const ScalarField map = smoothed_by_steps(toy_->value<ScalarField>("map.PS", mesh_unit(0)),
                                            edge_adjacency(mesh.vertices.size(), mesh.faces), 10);
  const Histogram reference = value_as<Histogram>(*toy_->resolver->value({toy_->index("reference"), Unit{}}));
  const MetricsOptions& options = toy_->config.metrics;
  const Scores expected = MetricsByMatching(options).score([&](std::span<const Metric> part, Matching read) {
    return score(part, read == Matching::histogram ? matched(map, reference) : min_max_normalised(map),
                 truth(), options, Rng(toy_->config.seed, "scores.PS", "1"),
                 measures_of(part, map.size(), mesh.vertices, mesh.faces));
  });
  const std::vector<ResultRow> smoothed = collect_smoothed(toy_->state(), 2);
  EXPECT_EQ(smoothed.at(0).model, "PS");
  EXPECT_EQ(smoothed.at(0).scores.values, expected.values);
}

TEST_F(Runs, SmoothedMapsOfCloudsAreSmoothedOverTheirPartialMesh) {
  const Mesh sphere = shapes::bumpy_sphere(2);
  write_toy_truth(data_.path(), "cat", sphere);
  data_.write("Meshes/cat.xyz", xyz_text(sphere.vertices));
  run("models: {RS: }\nmetrics: {names: [cc], matching: none, smoothing: [1, 2]}\n");
  const Unit cloud{kClouds, 0};
  const ScalarField map =
      smoothed_by_steps(toy_->value<ScalarField>("map.RS", cloud),
                        edge_adjacency(sphere.vertices.size(), toy_->value<Faces>("surface", cloud)), 2);
  const std::vector<ResultRow> smoothed = collect_smoothed(toy_->state(), 1);
  ASSERT_THAT(smoothed, SizeIs(1));
  EXPECT_EQ(smoothed[0].dataset, "clouds");
  EXPECT_NEAR(smoothed[0].value(0), cc(map, toy_->value<GroundTruth>("cloud_ground_truth", cloud).saliency),
              1e-12);
}

}  // namespace
}  // namespace salbench
