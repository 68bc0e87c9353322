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
    Runs::run(
        fmt::format("dataset: {{layout: {}, scans: {}}}\nscan: {{step_degrees: 2}}\n"
                    "models: {{MC: , CB: , RS: , HS: {{draws: 2}}}}\n"
                    "metrics: {{names: all, splits: 5{}}}\n",
                    layout, scans, matching));
    EXPECT_THAT(failures(), IsEmpty());
  }
  bool is_seen(std::size_t i) const { return mesh_.vertices[i].x() > -0.3; }
  std::string mask() const {
    std::string lines;
    for (std::size_t i = 0; i < n_; ++i) lines += is_seen(i) ? "1\n" : "0\n";
    return lines;
  }
  std::string values() const {
    std::string lines;
    for (std::size_t i = 0; i < n_; ++i) lines += fmt::format("{}\n", i * 37 % 53);
    return lines;
  }
  // Compares with scores of a shape that has only the visible points.
  void expect_scores_of_seen(const ResultRow& row) const {
    const Unit unit = row.job.unit;
    const auto truth = toy_->value<GroundTruth>("ground_truth", unit);
    const auto map = toy_->value<ScalarField>("map." + row.model, unit);
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
          const Rng draws(toy_->config.seed, "scores", toy_->project.units.name(unit));
          const ScalarField read_map = read == Matching::histogram
                                           ? toy_->value<ScalarField>("matched." + row.model, unit)
                                           : min_max_normalised(map);
          return score(metrics, values_at(read_map, seen), truth_at(truth, seen), options, draws, measures);
        });
    EXPECT_THAT(row.scores.values, Pointwise(testing::NanSensitiveDoubleEq(), expected.values)) << row.model;
    EXPECT_EQ(row.scores.n_points, static_cast<std::int64_t>(seen.size()));
  }
  std::string masked() {
    return data_set(R"(
def items(root):
    (shape,), clicks = ([one.path for one in match(root, names)] for names in ("shapes/*", "clicks/*"))
    return [Item("cat", [shape, f"{root}/masks/cat.txt", f"{root}/maps/cat.txt", *clicks], participants=len(clicks))]

def read(item):
    shape = (cloud if item.files[0].endswith(".xyz") else mesh)(item.files[0])
    n = len(shape.points)
    shape.ground_truth = values(item.files[2], n)
    shape.ground_truth[~mask(item.files[1], n)] = float("nan")
    shape.participants = [picks(path, n) for path in item.files[3:]]
    return shape
)");
  }

  const Mesh mesh_ = shapes::bumpy_sphere(2);
  const std::size_t n_ = mesh_.vertices.size();
};

const std::vector<std::string> kMatchings = {"", ", matching: none", ", matching: histogram"};

TEST_F(MaskedScores, OfMeshesAreThoseOfThePartThatWasSeen) {
  data_.write("shapes/cat.off", off_text(mesh_));
  data_.write("maps/cat.txt", values());
  data_.write("masks/cat.txt", mask());
  data_.write("clicks/cat_0.pid", "3\n8\n40\n77\n");
  data_.write("clicks/cat_1.pid", "3\n5\n100\n150\n");
  const std::string own = masked();
  for (const std::string& matching : kMatchings) {
    run_all_metrics(own, matching);
    ASSERT_THAT(toy_->results(), SizeIs(4));
    for (const ResultRow& row : toy_->results())
      if (row.model != "HS") expect_scores_of_seen(row);
  }
}

TEST_F(MaskedScores, DoNotDependOnPicksOfWhatIsHidden) {
  data_.write("shapes/cat.off", off_text(mesh_));
  data_.write("maps/cat.txt", values());
  data_.write("masks/cat.txt", mask());
  std::string hidden_picks;
  for (std::size_t i = 0; i < n_; ++i)
    if (!is_seen(i)) hidden_picks += fmt::format("{}\n", i);
  ASSERT_FALSE(hidden_picks.empty());
  const std::string own = masked();
  const auto scores = [&](const std::string& more_picks, const std::string& matching) {
    for (const auto& [k, picks] : {std::pair(0, "3\n8\n40\n"), {1, "3\n5\n"}, {2, "8\n40\n77\n"}})
      data_.write(fmt::format("clicks/cat_{}.pid", k), picks + more_picks);
    run_all_metrics(own, matching, true);
    return results();
  };
  for (const std::string& matching : kMatchings) {
    const std::string plain = scores("", matching);
    EXPECT_THAT(plain, HasSubstr(",HS,"));
    EXPECT_EQ(scores(hidden_picks, matching), plain) << "models, people, and scans";
  }
}

TEST_F(MaskedScores, OfCloudsAreThoseOfThePartThatWasSeen) {
  data_.write("shapes/cat.xyz", xyz_text(mesh_.vertices));
  data_.write("maps/cat.txt", values());
  data_.write("masks/cat.txt", mask());
  run_all_metrics(masked(), "");
  const auto truth = toy_->value<GroundTruth>("cloud_ground_truth", {kClouds, 0});
  for (std::size_t i = 0; i < n_; ++i) EXPECT_EQ(std::isnan(truth.saliency[i]), !is_seen(i));
  ASSERT_THAT(toy_->results(), SizeIs(3));
  EXPECT_LT(toy_->results()[0].scores.n_points, static_cast<std::int64_t>(n_));
}

}  // namespace
}  // namespace salbench
