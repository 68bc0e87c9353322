// SPDX-License-Identifier: GPL-3.0-or-later
// Maps are predicted on the whole shape and scored where ground truth is visible: by every metric, for models
// and people.

#include "pipeline/results/tables.h"
#include "stages/core/field.h"
#include "stages/core/seen.h"
#include "stages/geometry/centre.h"
#include "stages/geometry/mesh_ops.h"
#include "stages/metrics/by_matching.h"
#include "stages/metrics/score.h"
#include "tests/pipeline/data_sets.h"
#include "tests/support/cloud_text.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

class MaskedScores : public DataSets {
 protected:
  void run_all_metrics(const std::string& layout, const std::string& matching, bool scans = false) {
    toy_.reset();
    toy_ = std::make_unique<ToyRun>(data_.path(), store_,
                                    fmt::format("dataset: {{layout: {}, scans: {}}}\nscan: {{step_degrees: "
                                                "2}}\nmodels: {{MC: , CB: , RS: , HS: {{draws: 2}}}}\n"
                                                "metrics: {{names: all, splits: 5{}}}\n",
                                                layout, scans, matching));
    toy_->run();
    EXPECT_THAT(failures(), IsEmpty());
  }
  bool is_seen(std::size_t i) const { return mesh_.vertices[i].x() > -0.3; }
  std::string mask() const {
    std::string lines;
    for (std::size_t i = 0; i < n_; ++i) lines += is_seen(i) ? "1\n" : "0\n";
    return lines;
  }
  // Values that vary with `which`, and with `hidden` at unseen points.
  std::string values(double hidden, std::size_t which = 0) const {
    std::string lines;
    for (std::size_t i = 0; i < n_; ++i)
      lines += fmt::format("{}\n", is_seen(i) ? static_cast<double>((i * 37 + 11 * which) % 53)
                                              : hidden * static_cast<double>(i));
    return lines;
  }
  // Compares with scores of a shape that has only the visible points.
  void expect_scores_of_seen(const ResultRow& row) const {
    const auto value_of_unit = [&](std::string_view stage, Unit unit) {
      return toy_->resolver->value({toy_->index(stage), unit});
    };
    const auto value = [&](std::string_view stage) { return value_of_unit(stage, row.job.unit); };
    const GroundTruth truth = value_as<GroundTruth>(*value("ground_truth"));
    const ScalarField map = value_as<ScalarField>(*value("map." + row.model));
    const std::vector<std::int32_t> seen = *seen_points(truth.saliency);
    ASSERT_EQ(map.size(), n_) << "the map is of the whole shape";
    ASSERT_LT(seen.size(), n_);
    const Points points = mesh_.vertices;
    const ScalarField areas = values_at(barycentric_areas(points, mesh_.faces), seen),
                      centre = values_at(distances_from_centroid(points), seen);
    const auto& options = toy_->config.metrics;
    const Measures measures{
        .size = seen.size(),
        .areas = areas,
        .centre_bias = centre,
        .surface = measures_of(chosen_metrics(options), n_, points, mesh_.faces).at(seen).surface};
    const Scores expected =
        MetricsByMatching(options).score([&](std::span<const Metric> metrics, Matching read) -> Scores {
          const Rng draws(toy_->config.seed, "scores", toy_->project.units.name(row.job.unit));
          const ScalarField read_map = read == Matching::histogram
                                           ? value_as<ScalarField>(*value("matched." + row.model))
                                           : min_max_normalised(map);
          return score(metrics, values_at(read_map, seen), truth_at(truth, seen), options, draws, measures);
        });
    EXPECT_THAT(row.scores.values, Pointwise(testing::NanSensitiveDoubleEq(), expected.values)) << row.model;
    EXPECT_EQ(row.scores.n_points, static_cast<std::int64_t>(seen.size()));
  }
  // Tables as text, in which NaN equals NaN.
  std::string scores_text() const {
    return to_csv(results_table(toy_->results(), chosen_metrics(toy_->config.metrics)));
  }
  // A shape with values, or those of several viewers, and with picks; `more` changes the shape.
  std::string masked(const std::string& more = "") {
    return data_set(R"(
def items(root):
    (shape,), maps, clicks = ([one.path for one in match(root, names)] for names in ("shapes/*", "maps/*", "clicks/*"))
    return [Item("cat", [shape, f"{root}/masks/cat.txt", *maps, *clicks], participants=len(clicks),
                 viewers=len(maps) if len(maps) > 1 else 0, info=len(maps))]

def read(item):
    shape = (cloud if item.files[0].endswith(".xyz") else mesh)(item.files[0])
    n = len(shape.points)
    maps = [values(path, n) for path in item.files[2:2 + item.info]]
    for one in maps:
        one[~mask(item.files[1], n)] = float("nan")
    shape.truth, shape.viewers = sum(maps) / len(maps), maps if len(maps) > 1 else None
    shape.picks = [picks(path, n) for path in item.files[2 + item.info:]]
    )" + more + "\n    return shape\n");
  }

  const Mesh mesh_ = shapes::bumpy_sphere(2);
  const std::size_t n_ = mesh_.vertices.size();
};

const std::vector<std::string> kMatchings = {"", ", matching: none", ", matching: histogram"};

TEST_F(MaskedScores, OfMeshesAreThoseOfThePartThatWasSeen) {
  data_.write("shapes/cat.off", off_text(mesh_));
  data_.write("maps/cat.txt", values(1));
  data_.write("masks/cat.txt", mask());
  data_.write("clicks/cat_0.pid", "3\n8\n40\n77\n");
  data_.write("clicks/cat_1.pid", "3\n5\n100\n150\n");
  const std::string own = masked();
  for (const std::string& matching : kMatchings) {
    run_all_metrics(own, matching);
    ASSERT_THAT(toy_->results(), SizeIs(4));
    for (const ResultRow& row : toy_->results())
      if (row.model != "HS") expect_scores_of_seen(row);
    const std::vector<double> scores = toy_->results()[0].scores.values;
    const std::vector<Metric> metrics = chosen_metrics(toy_->config.metrics);
    for (std::size_t m = 0; m < metrics.size(); ++m)  // alone in its set, a shape has no others
      EXPECT_EQ(std::isfinite(scores[m]), metrics[m].reads != Reads::other_shapes) << metrics[m].name;
  }
}

TEST_F(MaskedScores, DoNotDependOnWhatIsHidden) {
  data_.write("shapes/cat.off", off_text(mesh_));
  data_.write("masks/cat.txt", mask());
  std::string hidden_picks;
  for (std::size_t i = 0; i < n_; ++i)
    if (!is_seen(i)) hidden_picks += fmt::format("{}\n", i);
  ASSERT_FALSE(hidden_picks.empty());
  const std::string own = masked();
  const auto scores = [&](double hidden, const std::string& more_picks, const std::string& matching) {
    data_.write("maps/cat.txt", values(hidden));
    for (const auto& [k, picks] : {std::pair(0, "3\n8\n40\n"), {1, "3\n5\n"}, {2, "8\n40\n77\n"}})
      data_.write(fmt::format("clicks/cat_{}.pid", k), picks + more_picks);
    run_all_metrics(own, matching, true);
    return scores_text();
  };
  for (const std::string& matching : kMatchings) {
    const std::string plain = scores(0, "", matching);
    EXPECT_THAT(plain, HasSubstr(",HS,"));
    EXPECT_EQ(scores(1e6, hidden_picks, matching), plain) << "models, people, and scans";
  }
}

TEST_F(MaskedScores, OfViewersDoNotDependOnWhatIsHidden) {
  data_.write("shapes/cat.off", off_text(mesh_));
  data_.write("masks/cat.txt", mask());
  const auto scores = [&](double hidden, const std::string& matching) {
    for (const std::size_t viewer : {1U, 2U, 3U})
      data_.write(fmt::format("maps/cat_{}.txt", viewer),
                  values(hidden * static_cast<double>(viewer), viewer));
    run_all_metrics(masked(), matching);
    return scores_text();
  };
  for (const std::string& matching : kMatchings) {
    const std::string plain = scores(0, matching);
    EXPECT_THAT(plain, HasSubstr(",HS,"));
    EXPECT_EQ(scores(-1e6, matching), plain);
  }
}

TEST_F(MaskedScores, OfViewsDoNotDependOnWhatIsHidden) {
  data_.write("shapes/cat.off", off_text(mesh_));
  data_.write("masks/cat.txt", mask());
  const auto scores = [&](double hidden) {
    for (const std::size_t view : {1U, 2U})
      data_.write(fmt::format("maps/cat_{}.txt", view), values(hidden, view));
    run_all_metrics(data_set(R"(
def items(root):
    return [Item(f"cat_{one.view}", [f"{root}/shapes/cat.off", one.path, f"{root}/masks/cat.txt"], shape="cat",
                 view=one.view)
            for one in match(root, "maps/cat_{view}.txt")]

def read(item):
    shape = mesh(item.files[0])
    shape.truth = values(item.files[1], len(shape.points))
    shape.truth[~mask(item.files[2], len(shape.points))] = float("nan")
    shape.picks = [top(shape.truth, 20)]
    return shape
)"),
                    "");
    EXPECT_THAT(toy_->results(), SizeIs(6));
    return scores_text();
  };
  EXPECT_EQ(scores(5), scores(0));
}

TEST_F(MaskedScores, OfCloudsDoNotDependOnWhatIsHidden) {
  data_.write("shapes/cat.xyz", xyz_text(mesh_.vertices));
  data_.write("masks/cat.txt", mask());
  const auto scores = [&](double hidden) {
    data_.write("maps/cat.txt", values(hidden));
    run_all_metrics(masked(), "");
    EXPECT_THAT(toy_->results(), SizeIs(3));
    return scores_text();
  };
  EXPECT_EQ(scores(5), scores(0));
}

TEST_F(MaskedScores, WithPositivesByRuleAreThoseOfTheMetricThatHasTheRule) {
  data_.write("shapes/cat.off", off_text(mesh_));
  data_.write("maps/cat.txt", values(1e6));
  data_.write("masks/cat.txt", mask());
  const auto run_rule = [&](const std::string& rule) {
    run_all_metrics(masked(fmt::format("shape.picks = [{}]", rule)), ", matching: none");
    const GroundTruth made = truth();
    EXPECT_THAT(made.picks, SizeIs(1));
    for (const std::int32_t pick : made.picks.at(0)) EXPECT_TRUE(is_seen(index(pick)));
  };
  const auto value = [&](const ResultRow& row, std::string_view metric) {
    return value_of(row.scores, metric, toy_->config.metrics);
  };
  run_rule("top(shape.truth, 20)");
  for (const ResultRow& row : toy_->results())
    EXPECT_NEAR(value(row, "auc_exact"), value(row, "auc_top20"), 1e-12) << row.model;
  const std::size_t top = truth().picks.at(0).size();
  run_rule("above_mean(shape.truth)");
  EXPECT_GT(truth().picks.at(0).size(), top);
}

}  // namespace
}  // namespace salbench
