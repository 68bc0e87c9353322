// SPDX-License-Identifier: GPL-3.0-or-later
// Point clouds beside meshes and scans, from their files to their scores.

#include "stages/geometry/smoothing.h"
#include "stages/normals/normals.h"
#include "stages/surface/surface.h"
#include "tests/pipeline/runner_fixture.h"
#include "tests/support/cloud_text.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

constexpr const char* kAllModels = "dataset: {scans: false}\n";
constexpr const char* kPointModels = "dataset: {scans: false}\nmodels: {LS: , CS: , PS: , RS: }\n";

// The mesh "1", and the cloud "2" of its vertices with its normals; both with ground truth.
class Clouds : public Runs {
 protected:
  Clouds() {
    write_toy_item(data_.path(), "1", mesh_);
    truth_ = write_toy_truth(data_.path(), "2", mesh_);
    data_.write("Meshes/2.xyz", xyz_text(mesh_.vertices, mesh_normals(mesh_)));
  }
  void run_soundly(const std::string& yaml, int threads = 2) {
    run(yaml, threads);
    ASSERT_THAT(failures(), IsEmpty());
  }
  ScalarField map_of(const std::string& model, Unit unit) const {
    return toy_->value<ScalarField>("map." + model, unit);
  }
  GroundTruth cloud_truth() const { return toy_->value<GroundTruth>("cloud_ground_truth", kCloud2); }

  static constexpr Unit kCloud2{kClouds, 1};
  const Mesh mesh_ = shapes::bumpy_sphere(3);
  GroundTruth truth_;  // one value per point of the cloud
};

// Rules for a data set with one shape of each level.
Rules rules_for(const Config& config, const std::vector<Level>& shapes) {
  std::vector<Family> families;
  for (const Level level : shapes) families.push_back({level, "a", Item()});
  return make_rules(config, {.units = Units(levels(), families)});
}

TEST_F(Clouds, WithAMeshsNormalsHaveTheMeshsMapsToTheBit) {
  for (const char* protocol : {"published", "text"}) {
    run_soundly(fmt::format("protocol: {}\nnormals: {{method: faces}}\n{}", protocol, kPointModels));
    for (const char* model : {"LS", "CS", "PS"})
      EXPECT_EQ(map_of(model, kCloud2), map_of(model, mesh_unit(0))) << model;
  }
}

TEST_F(Clouds, HaveMapsAndScoresOfEveryModelButHumanPerformance) {
  run_soundly(kAllModels);
  for (const char* model : {"LS", "CS", "PS", "MS"}) {
    const ScalarField map = map_of(model, kCloud2);
    ASSERT_THAT(map, SizeIs(mesh_.vertices.size()));
    EXPECT_TRUE(std::ranges::all_of(map, [](double v) { return std::isfinite(v); })) << model;
    EXPECT_LT(*std::ranges::min_element(map), *std::ranges::max_element(map)) << model;
  }
  std::vector<std::string> models;
  for (const ResultRow& row : toy_->results())
    if (row.dataset == "clouds") {
      EXPECT_EQ(row.item, "2");
      EXPECT_EQ(row.view, "");
      EXPECT_EQ(row.scores.n_points, static_cast<std::int64_t>(mesh_.vertices.size()));
      models.push_back(row.model);
    }
  EXPECT_THAT(models, ElementsAre("LS", "CS", "PS", "MS", "RS"));
}

TEST_F(Clouds, HaveRowsOnlyWhereTheDataSetHoldsSome) {
  const Config config = toy_config("picture: {size: 40}\n");
  const auto rows_of = [](const Rules& rules, Level level) {
    return std::count_if(rules.begin(), rules.end(), [&](const Rule& rule) { return rule.over == level; });
  };
  const Rules meshes = make_rules(config), clouds = rules_for(config, {kClouds}),
              both = rules_for(config, {kMeshes, kClouds});
  EXPECT_EQ(rows_of(meshes, kClouds), 0);
  EXPECT_EQ(rows_of(clouds, kMeshes) + rows_of(clouds, kScans), 0);
  EXPECT_EQ(rows_of(both, kClouds), rows_of(clouds, kClouds));
  // The other rows are unaffected by the clouds.
  std::vector<std::string> without, beside;
  for (const Rule& rule : meshes) without.push_back(node_name(rule));
  for (const Rule& rule : both)
    if (rule.over != kClouds) beside.push_back(node_name(rule));
  EXPECT_EQ(beside, without);
}

TEST_F(Clouds, AreFoundInTheCacheByTheNextRunAndChangeNoKeyOfAMesh) {
  ToyRun(data_.path(), store_, kToyConfig, "1").run();
  ToyRun both(data_.path(), store_);
  for (std::size_t rule = 0; rule < both.project.rules.size(); ++rule) {
    if (both.project.rules[rule].over == kClouds) continue;
    EXPECT_EQ(both.plan().open(rule), 0U) << node_name(both.project.rules[rule]);
  }
  both.run();
  const ToyRun again(data_.path(), store_);
  EXPECT_EQ(again.open(), 0U);
  EXPECT_FALSE(has_work(*again.resolver));
}

// Including meshes, scans and pictures.
TEST_F(Clouds, ComeOutTheSameOnAnyNumberOfThreads) {
  data_.write("Meshes/3.ply", ply_cloud_text(shapes::bumpy_sphere(2).vertices));
  std::vector<Digest> first;
  for (const int threads : {1, 4}) {
    store_.clear();
    run_soundly("scan: {step_degrees: 1}\nmodels: {CS: , MS: , PS: , RS: }\npicture: {size: 40}\n", threads);
    std::vector<Digest> contents;
    for (const Job& job : toy_->project.jobs()) contents.push_back(toy_->plan()[job].content);
    if (first.empty()) first = contents;
    EXPECT_TRUE(contents == first) << threads;
  }
}

// The cloud "2" without the positions of the points 0 and 100.
TEST_F(Clouds, GroundTruthCountsThePointsOfTheFile) {
  std::vector<Vec3> points = mesh_.vertices;
  points[0].x() = points[100].y() = kNan;
  data_.write("Meshes/2.xyz", xyz_text(points, mesh_normals(mesh_)));
  for (int k = 0; k < 4; ++k) data_.write(fmt::format("RawData/2_{}.pid", k), "1\n101\n300\n");
  run_soundly(kPointModels);
  const GroundTruth truth = cloud_truth();
  EXPECT_THAT(truth.picks, AllOf(SizeIs(4), Each(ElementsAre(0, 99, 298))));
  ASSERT_THAT(truth.saliency, SizeIs(points.size() - 2));
  EXPECT_EQ(truth.saliency[0], truth_.saliency[1]);
  EXPECT_EQ(truth.saliency[98], truth_.saliency[99]);
  EXPECT_EQ(truth.saliency[99], truth_.saliency[101]);
  EXPECT_EQ(truth.saliency.back(), truth_.saliency.back());
}

TEST_F(Clouds, PicksAloneAreSmoothedOverThePartialMesh) {
  std::filesystem::remove(data_ / "Distributions/2.val");
  run_soundly(kPointModels);
  const Faces faces = partial_mesh(mesh_.vertices, mesh_normals(mesh_));
  EXPECT_EQ(cloud_truth().saliency, smoothed_picks({mesh_.vertices, faces}, cloud_truth().picks));
}

TEST_F(Clouds, MayHaveMadeUpParticipantsAndMetricsByArea) {
  run_soundly("dataset: {scans: false, participants: simulated}\nmodels: {PS: , MS: }\nmetrics: [all]\n");
  EXPECT_TRUE(cloud_truth().simulated);
  for (const ResultRow& row : toy_->results())
    for (std::size_t m = 0; m < metrics().size(); ++m)  // each is the only shape of its kind
      EXPECT_EQ(std::isfinite(row.value(m)), metrics()[m].reads != Reads::other_shapes)
          << row.dataset << row.model << metrics()[m].name;
}

TEST_F(Clouds, ThatCannotBeReadFailAloneAndSayWhy) {
  data_.write("Meshes/3.xyz", "1 2 3\n4 5\n");
  data_.write("Meshes/4.ply", ply_cloud_text(std::vector<Vec3>(3, Vec3(1, 2, 3))));
  data_.write("Meshes/5.off", "OFF\n3 0 0\n1 2 3\n1 2 4\n1 3 3\n");
  run(kPointModels);
  EXPECT_THAT(failures(), ElementsAre(HasSubstr("3.xyz:2: "), HasSubstr("at least 9"), HasSubstr("PLY")));
  EXPECT_THAT(map_of("PS", kCloud2), SizeIs(mesh_.vertices.size()));
}

}  // namespace
}  // namespace salbench
