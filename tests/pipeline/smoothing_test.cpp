// SPDX-License-Identifier: GPL-3.0-or-later
// Scores of smoothed maps are additional, and change no others.

#include "pipeline/results/tables.h"
#include "stages/core/field.h"
#include "stages/geometry/laplacian.h"
#include "stages/matching/matching.h"
#include "stages/metrics/by_matching.h"
#include "stages/metrics/score.h"
#include "tests/pipeline/runner_fixture.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

const std::string kSmoothing =
    std::string(kToyConfig) + "metrics: {names: [auc_exact, cc, kl, cc_area], smoothing: [0, 3, 10]}\n";

TEST_F(RunnerTest, SmoothedMapsAreScoredBesideTheOthers) {
  const std::string plain = std::string(kToyConfig) + "metrics: {names: [auc_exact, cc, kl, cc_area]}\n";
  run(plain);
  const std::string results = results_;
  const auto computed = run(kSmoothing);
  EXPECT_EQ(results_, results);
  EXPECT_THAT(computed, Each(AnyOf(HasSubstr("smoothed_scores."), HasSubstr("smoothed_table."))));
  EXPECT_THAT(computed, SizeIs(JobCounts(kSmoothing).where([](const Rule& rule) {
                return has_role(rule, Role::smoothed_scores) || has_role(rule, Role::smoothed_table);
              })));
  EXPECT_THAT(run(kSmoothing), IsEmpty());
  EXPECT_THAT(run(plain), IsEmpty());
}

class Smoothing : public testing::Test {
 protected:
  Smoothing() {
    for (const int k : {1, 2, 3})
      write_toy_item(data_.path(), std::to_string(k), shapes::bumpy_sphere(2, 0.1 * k));
  }
  ToyRun& run(const std::string& yaml) {
    toy_ = std::make_unique<ToyRun>(data_.path(), store_, yaml);
    toy_->run();
    return *toy_;
  }
  TemporaryFolder data_;
  MemoryStore store_;
  std::unique_ptr<ToyRun> toy_;
};

TEST_F(Smoothing, ScoresAreThoseOfTheSmoothedMaps) {
  ToyRun& toy = run(kSmoothing);
  const std::vector<Metric> metrics = chosen_metrics(toy.config.metrics);
  const std::vector<ResultRow> rows = toy.results();
  const Table table = smoothed_table(toy.state(), metrics);
  EXPECT_THAT(std::vector(table.columns.begin(), table.columns.begin() + 3),
              ElementsAre("smoothing", "dataset", "item"));
  ASSERT_THAT(table.rows, SizeIs(3 * rows.size()));
  EXPECT_EQ(table.rows[rows.size()][0], Cell("3"));
  EXPECT_EQ(std::vector(table.rows[0].begin() + 1, table.rows[0].end()),
            results_table(rows, metrics).rows[0]);
  EXPECT_EQ(table.rows[rows.size()][2], Cell(rows[0].item));
  const auto value = [&](std::string_view stage) {
    return toy.resolver->value({toy.index(stage), mesh_unit(0)});
  };
  const Mesh mesh = value_as<Mesh>(*value("mesh"));
  const GroundTruth truth = value_as<GroundTruth>(*value("ground_truth"));
  const ScalarField map = smoothed_by_steps(value_as<ScalarField>(*value("map.PS")),
                                            edge_adjacency(mesh.vertices.size(), mesh.faces), 10);
  const Histogram reference = value_as<Histogram>(*toy.resolver->value({toy.index("reference"), Unit{}}));
  const Scores expected =
      MetricsByMatching(toy.config.metrics).score([&](std::span<const Metric> part, Matching read) {
        return score(part, read == Matching::histogram ? matched(map, reference) : min_max_normalised(map),
                     truth, toy.config.metrics, Rng(toy.config.seed, "scores.PS", "1"),
                     measures_of(part, map.size(), mesh.vertices, mesh.faces));
      });
  const std::vector<ResultRow> smoothed = collect_smoothed(toy.state(), 2);
  EXPECT_EQ(smoothed.at(0).model, "PS");
  EXPECT_EQ(smoothed.at(0).scores.values, expected.values);
}

TEST_F(Smoothing, OfCloudsIsOverTheirPartialMesh) {
  const Mesh sphere = shapes::bumpy_sphere(2);
  const TemporaryFolder folder;
  std::string points, values;
  for (const Vec3& v : sphere.vertices) {
    points += fmt::format("{} {} {}\n", v.x(), v.y(), v.z());
    values += fmt::format("{}\n", v.z());
  }
  folder.write("data/clouds/cat.xyz", points);
  folder.write("data/maps/cat.txt", values);
  const auto own = folder.write("own.py", R"(from salbench.datasets import Item

def items(root):
    return [Item("cat", [f"{root}/clouds/cat.xyz"], saliency=f"{root}/maps/cat.txt")]
)");
  ToyRun toy(folder / "data", store_,
             fmt::format("dataset: {{layout: {}}}\nmodels: {{RS: }}\nmetrics: {{names: [cc], matching: none, "
                         "smoothing: [0, 2]}}\n",
                         own.string()));
  toy.run();
  const auto value = [&](std::string_view stage) {
    return toy.resolver->value({toy.index(stage, kClouds), Unit{kClouds, 0}});
  };
  const Faces surface = value_as<Faces>(*value("surface"));
  const ScalarField map = smoothed_by_steps(value_as<ScalarField>(*value("map.RS")),
                                            edge_adjacency(sphere.vertices.size(), surface), 2);
  const std::vector<ResultRow> smoothed = collect_smoothed(toy.state(), 1);
  ASSERT_THAT(smoothed, SizeIs(1));
  EXPECT_EQ(smoothed[0].dataset, "clouds");
  EXPECT_NEAR(smoothed[0].value(0), cc(map, value_as<GroundTruth>(*value("cloud_ground_truth")).saliency),
              1e-12);
}

TEST_F(Smoothing, HasItsTableWhereItIsAskedFor) {
  const auto is_there = [&](const std::string& yaml) {
    ToyRun& toy = run(yaml);
    const std::vector<TableFile> files = table_files(toy.state(), toy.results(), {});
    return std::ranges::find(files, "smoothed.csv", &TableFile::name)->text.has_value();
  };
  EXPECT_TRUE(is_there(kSmoothing));
  EXPECT_FALSE(is_there(kToyConfig));
}

TEST_F(Smoothing, WrongStepsAreNamedWithTheirLine) {
  EXPECT_THAT([&] { toy_config("metrics: {smoothing: [10, 0]}\n"); },
              Refuses<ConfigError>("toy.yaml:1: metrics.smoothing has 0 after 10"));
  EXPECT_THAT(toy_config("metrics: {smoothing: 5}\n").metrics.smoothing, ElementsAre("5"));
}

}  // namespace
}  // namespace salbench
