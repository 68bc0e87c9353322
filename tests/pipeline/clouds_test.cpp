// SPDX-License-Identifier: GPL-3.0-or-later
// Point clouds beside meshes and scans, from their files to their scores.

#include "stages/geometry/smoothing.h"
#include "stages/normals/normals.h"
#include "stages/surface/surface.h"
#include "tests/support/cloud_text.h"
#include "tests/support/memory_store.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"
#include "tests/support/toy_data.h"

namespace salbench {
namespace {

constexpr const char* kAllModels = "dataset: {scans: false}\n";
constexpr const char* kPointModels = "dataset: {scans: false}\nmodels: {LS: , CS: , PS: , RS: }\n";

// The mesh "1", and the cloud "2" of its vertices with its normals; both with ground truth.
struct Twins12 {
  Mesh mesh = shapes::bumpy_sphere(3);
  GroundTruth truth;  // ground truth of the cloud
  TemporaryFolder folder;

  Twins12() {
    write_toy_item(folder.path(), "1", mesh);
    truth = write_toy_truth(folder.path(), "2", mesh);
    folder.write("Meshes/2.xyz", xyz_text(mesh.vertices, mesh_normals(mesh)));
  }
};

template <class T>
T result(ToyRun& toy, const std::string& stage, Unit unit) {
  return value_as<T>(*toy.resolver->value({toy.index(stage, unit.level), unit}));
}

ScalarField map_of(ToyRun& toy, const std::string& model, Unit unit) {
  return result<ScalarField>(toy, "map." + model, unit);
}

Unit cloud_unit(std::uint32_t family) { return {kClouds, family}; }

// Rules for a data set with one shape of each level.
Rules rules_for(const Config& config, const std::vector<Level>& shapes) {
  std::vector<Family> families;
  for (const Level level : shapes) families.push_back({level, "a", Item()});
  return make_rules(config, {.units = Units(levels(), families)});
}

TEST(Clouds, WithAMeshsNormalsHaveTheMeshsMapsToTheBit) {
  const Twins12 data;
  for (const char* protocol : {"published", "text"}) {
    MemoryStore store;
    ToyRun toy(data.folder.path(), store,
               fmt::format("protocol: {}\nnormals: {{method: faces}}\n{}", protocol, kPointModels));
    toy.run();
    ASSERT_THAT(toy.resolver->failures(), IsEmpty());
    for (const char* model : {"LS", "CS", "PS"})
      EXPECT_EQ(map_of(toy, model, cloud_unit(1)), map_of(toy, model, mesh_unit(0))) << model;
  }
}

TEST(Clouds, HaveMapsAndScoresOfEveryModelButHumanPerformance) {
  const Twins12 data;
  MemoryStore store;
  ToyRun toy(data.folder.path(), store, kAllModels);
  toy.run();
  ASSERT_THAT(toy.resolver->failures(), IsEmpty());
  for (const char* model : {"LS", "CS", "PS", "MS"}) {
    const ScalarField map = map_of(toy, model, cloud_unit(1));
    ASSERT_THAT(map, SizeIs(data.mesh.vertices.size()));
    EXPECT_TRUE(std::ranges::all_of(map, [](double v) { return std::isfinite(v); })) << model;
    EXPECT_LT(*std::ranges::min_element(map), *std::ranges::max_element(map)) << model;
  }
  std::vector<std::string> models;
  for (const ResultRow& row : toy.results())
    if (row.dataset == "clouds") {
      EXPECT_EQ(row.item, "2");
      EXPECT_EQ(row.view, "");
      EXPECT_EQ(row.scores.n_points, static_cast<std::int64_t>(data.mesh.vertices.size()));
      models.push_back(row.model);
    }
  EXPECT_THAT(models, ElementsAre("LS", "CS", "PS", "MS", "RS"));
}

TEST(Clouds, HaveRowsOnlyWhereTheDataSetHoldsSome) {
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

TEST(Clouds, AreFoundInTheCacheByTheNextRunAndChangeNoKeyOfAMesh) {
  const Twins12 data;
  MemoryStore store;
  {
    ToyRun alone(data.folder.path(), store, kToyConfig, "1");
    alone.run();
    ASSERT_THAT(alone.resolver->failures(), IsEmpty());
  }
  ToyRun both(data.folder.path(), store);
  for (std::size_t rule = 0; rule < both.project.rules.size(); ++rule) {
    if (both.project.rules[rule].over == kClouds) continue;
    EXPECT_EQ(both.plan().open(rule), 0U) << node_name(both.project.rules[rule]);
  }
  both.run();
  ToyRun again(data.folder.path(), store);
  EXPECT_EQ(again.open(), 0U);
  EXPECT_FALSE(has_work(*again.resolver));
}

// Including meshes, scans and pictures.
TEST(Clouds, ComeOutTheSameOnAnyNumberOfThreads) {
  const Twins12 data;
  data.folder.write("Meshes/3.ply", ply_cloud_text(shapes::bumpy_sphere(2).vertices));
  std::vector<Digest> first;
  for (const int threads : {1, 2, 4}) {
    MemoryStore store;
    ToyRun toy(data.folder.path(), store,
               "scan: {step_degrees: 1}\nmodels: {CS: , MS: , PS: , RS: }\npicture: {size: 40}\n");
    toy.run(threads);
    ASSERT_THAT(toy.resolver->failures(), IsEmpty());
    std::vector<Digest> contents;
    for (const Job& job : toy.project.jobs()) contents.push_back(toy.plan()[job].content);
    if (first.empty()) first = contents;
    EXPECT_TRUE(contents == first) << threads;
  }
}

// The cloud "2" without the positions of the points 0 and 100.
TEST(Clouds, GroundTruthCountsThePointsOfTheFile) {
  const Twins12 data;
  std::vector<Vec3> points = data.mesh.vertices;
  points[0].x() = points[100].y() = kNan;
  data.folder.write("Meshes/2.xyz", xyz_text(points, mesh_normals(data.mesh)));
  for (int k = 0; k < 4; ++k) data.folder.write(fmt::format("RawData/2_{}.pid", k), "1\n101\n300\n");
  MemoryStore store;
  ToyRun toy(data.folder.path(), store, kPointModels);
  toy.run();
  ASSERT_THAT(toy.resolver->failures(), IsEmpty());
  const auto truth = result<GroundTruth>(toy, "cloud_ground_truth", cloud_unit(1));
  EXPECT_THAT(truth.picks, AllOf(SizeIs(4), Each(ElementsAre(0, 99, 298))));
  ASSERT_THAT(truth.saliency, SizeIs(points.size() - 2));
  EXPECT_EQ(truth.saliency[0], data.truth.saliency[1]);
  EXPECT_EQ(truth.saliency[98], data.truth.saliency[99]);
  EXPECT_EQ(truth.saliency[99], data.truth.saliency[101]);
  EXPECT_EQ(truth.saliency.back(), data.truth.saliency.back());
}

TEST(Clouds, GroundTruthThatDoesNotFitIsToldInPoints) {
  const Twins12 data;
  const std::size_t n = data.mesh.vertices.size();
  MemoryStore store;
  const auto cause = [&] {
    ToyRun toy(data.folder.path(), store, kPointModels);
    toy.run();
    return toy.resolver->failures().empty() ? "no failure" : toy.resolver->failures()[0].cause;
  };
  data.folder.write("RawData/2_0.pid", fmt::format("3\n{}\n", n));
  EXPECT_THAT(cause(), HasSubstr(fmt::format("2_0.pid:2: point {0} is out of range: the point cloud has {0} "
                                             "points, numbered from 0",
                                             n)));
  data.folder.write("Distributions/2.val", "1\n");
  EXPECT_THAT(cause(),
              HasSubstr(fmt::format("2.val:1: the file has 1 values, but the point cloud has {} points", n)));
}

TEST(Clouds, PicksAloneAreSmoothedOverThePartialMesh) {
  const Twins12 data;
  std::filesystem::remove(data.folder / "Distributions/2.val");
  MemoryStore store;
  ToyRun toy(data.folder.path(), store, kPointModels);
  toy.run();
  ASSERT_THAT(toy.resolver->failures(), IsEmpty());
  const auto truth = result<GroundTruth>(toy, "cloud_ground_truth", cloud_unit(1));
  const Faces faces = partial_mesh(data.mesh.vertices, mesh_normals(data.mesh));
  EXPECT_EQ(truth.saliency, smoothed_picks({data.mesh.vertices, faces}, truth.picks));
}

TEST(Clouds, MayHaveMadeUpParticipantsAndMetricsByArea) {
  const Twins12 data;
  MemoryStore store;
  ToyRun toy(data.folder.path(), store,
             "dataset: {scans: false, participants: simulated}\nmodels: {PS: , MS: }\nmetrics: [all]\n");
  toy.run();
  ASSERT_THAT(toy.resolver->failures(), IsEmpty());
  EXPECT_TRUE(result<GroundTruth>(toy, "cloud_ground_truth", cloud_unit(1)).simulated);
  const std::vector<Metric> metrics = chosen_metrics(toy.config.metrics);
  for (const ResultRow& row : toy.results())
    for (std::size_t m = 0; m < metrics.size(); ++m)  // each is the only one of its kind: there are no others
      EXPECT_EQ(std::isfinite(row.scores.values[m]), metrics[m].reads != Reads::other_shapes)
          << row.dataset << row.model << metrics[m].name;
}

TEST(Clouds, ThatCannotBeReadFailAloneAndSayWhy) {
  const Twins12 data;
  data.folder.write("Meshes/3.xyz", "1 2 3\n4 5\n");
  data.folder.write("Meshes/4.ply", ply_cloud_text(std::vector<Vec3>(3, Vec3(1, 2, 3))));
  data.folder.write("Meshes/5.off", "OFF\n3 0 0\n1 2 3\n1 2 4\n1 3 3\n");
  MemoryStore store;
  ToyRun toy(data.folder.path(), store, kPointModels);
  toy.run();
  std::vector<std::string> causes;
  for (const Failure& failure : toy.resolver->failures()) causes.push_back(failure.cause);
  EXPECT_THAT(causes, ElementsAre(HasSubstr("3.xyz:2: the line has 2 columns, the first one 3"),
                                  "the point cloud has 3 points with a position: it needs at least 9",
                                  "no faces: this is a point cloud; write it as PLY, PCD or XYZ"));
  EXPECT_THAT(map_of(toy, "PS", cloud_unit(1)), SizeIs(data.mesh.vertices.size()));
}

TEST(Clouds, AFileThatBecomesAMeshDuringTheRunIsRefused) {
  const TemporaryFolder folder;
  const Mesh mesh = shapes::bumpy_sphere(1);
  folder.write("1.ply", ply_cloud_text(mesh.vertices));
  MemoryStore store;
  ToyRun toy(folder.path(), store, kPointModels);
  std::string text = ply_cloud_text(mesh.vertices);
  text.replace(text.find("end_header"), 0, "element face 1\nproperty list uchar int vertex_indices\n");
  folder.write("1.ply", text + "3 0 1 2\n");
  toy.run();
  ASSERT_THAT(toy.resolver->failures(), SizeIs(1));
  EXPECT_THAT(toy.resolver->failures()[0].cause,
              HasSubstr("1.ply: changed since this run was planned; run it again"));
}

// Values and picks count the points of the file, the first of which has no position.
TEST(Clouds, MayBeReadByPython) {
  TemporaryFolder data, elsewhere;
  const Mesh mesh = shapes::bumpy_sphere(2);
  data.write("shapes/a.xyz", "nan nan nan\n" + xyz_text(mesh.vertices));
  std::string values = "id,density\n0,5\n1,-1\n";
  for (std::size_t i = 1; i < mesh.vertices.size(); ++i) values += fmt::format("{},{}\n", i + 1, i % 7);
  data.write("maps/a.csv", values);
  const auto own = elsewhere.write("own.py", R"(import numpy
from salbench.datasets import Item, cloud, numbers

def items(root):
    return [Item("a", [f"{root}/shapes/a.xyz", f"{root}/maps/a.csv"], participants=1)]

def read(item):
    shape, density = cloud(item.files[0]), numbers(item.files[1], ["density"])[:, 0]
    density[density == -1] = numpy.nan
    shape.truth, shape.picks = numpy.delete(density, shape.left_out), [[2, 7]]
    return shape
)");
  MemoryStore store;
  ToyRun toy(data.path(), store,
             fmt::format("dataset: {{layout: {}, scans: false}}\nmodels: {{RS: }}\n", own.string()));
  toy.run();
  ASSERT_THAT(toy.resolver->failures(), IsEmpty());
  ASSERT_EQ(toy.inputs.count(kClouds), 1U);
  const auto truth = result<GroundTruth>(toy, "cloud_ground_truth", cloud_unit(0));
  ASSERT_THAT(truth.saliency, SizeIs(mesh.vertices.size()));
  EXPECT_TRUE(std::isnan(truth.saliency[0]));
  EXPECT_EQ(truth.saliency[8], 1);
  EXPECT_THAT(truth.picks, ElementsAre(ElementsAre(2, 7)));
}

}  // namespace
}  // namespace salbench
