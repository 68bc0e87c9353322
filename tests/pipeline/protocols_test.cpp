// SPDX-License-Identifier: GPL-3.0-or-later
// A miniature of each public archive in its published names: read, inspected, and scored by its protocol.
#include <cmath>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/inputs/inspection.h"
#include "tests/pipeline/data_sets.h"
#include "tests/support/mat.h"

namespace salbench {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

std::string obj_text(const Mesh& mesh) {
  std::string text;
  for (const Vec3& v : mesh.vertices) text += fmt::format("v {} {} {}\n", v.x(), v.y(), v.z());
  for (const Triangle& f : mesh.faces) text += fmt::format("f {} {} {}\n", f[0] + 1, f[1] + 1, f[2] + 1);
  return text;
}

// One value per element, in lines.
template <class Value>
std::string lines(std::size_t n, const Value& value) {
  std::string text;
  for (std::size_t i = 0; i < n; ++i) text += fmt::format("{}\n", value(i));
  return text;
}

// Pearson correlation over the points that are seen, in the plainest way.
double correlation(const ScalarField& a, const ScalarField& b, const std::vector<bool>& seen) {
  double n = 0, mean_a = 0, mean_b = 0, ab = 0, aa = 0, bb = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (seen[i]) n += 1, mean_a += a[i], mean_b += b[i];
  mean_a /= n;
  mean_b /= n;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (seen[i]) {
      ab += (a[i] - mean_a) * (b[i] - mean_b);
      aa += (a[i] - mean_a) * (a[i] - mean_a);
      bb += (b[i] - mean_b) * (b[i] - mean_b);
    }
  return ab / std::sqrt(aa * bb);
}

class Protocols : public DataSets {
 protected:
  void run_protocol(const std::string& name) {
    const Config config =
        read_config(Section::from_file(fmt::format("{}/protocols/{}.yaml", SALBENCH_CONFIGS, name)), name);
    inspection_ = inspect_data(data_.path(), layouts_of(config.dataset.layout));
    toy_.reset();
    toy_ = std::make_unique<ToyRun>(data_.path(), store_, config);
    toy_->run();
    EXPECT_THAT(failures(), IsEmpty());
    EXPECT_THAT(inspection_.problems(), IsEmpty());
    for (const ResultRow& row : toy_->results())
      EXPECT_EQ(row.scores.values.size(), config.metrics.names.size());
  }
  // The score of each row by a metric of the protocol.
  double score(const ResultRow& row, const std::string& metric) const {
    const auto& names = toy_->config.metrics.names;
    return row.value(static_cast<std::size_t>(std::ranges::find(names, metric) - names.begin()));
  }
  std::set<std::string> scored_items() const {
    std::set<std::string> items;
    for (const ResultRow& row : toy_->results())
      items.insert(row.view.empty() ? row.item : row.item + "/" + row.view);
    return items;
  }
  ScalarField map(const std::string& model, std::size_t item) const {
    return value_as<ScalarField>(*toy_->resolver->value({toy_->index("map." + model), mesh_unit(item)}));
  }

  const Mesh sphere_ = shapes::bumpy_sphere(2);
  const std::size_t n_ = sphere_.vertices.size();
  DataInspection inspection_;
};

TEST_F(Protocols, ThreeDva) {
  const auto height = [&](std::size_t i) { return std::abs(sphere_.vertices[i].z()); };
  std::vector<bool> seen_599(n_);
  for (const char* mesh : {"bunny", "dragon"}) {
    data_.write(fmt::format("3DModels-Simplif/{}.obj", mesh), obj_text(sphere_));
    data_.write(fmt::format("3DModels-Simplif-up/{}.obj", mesh), obj_text(sphere_));
    for (const int view : {300, 413, 599}) {
      const auto sees = [&](std::size_t i) { return sphere_.vertices[i].x() > view / 1000.0 - 0.6; };
      for (std::size_t i = 0; i < n_; ++i) seen_599[i] = sees(i);
      data_.write(fmt::format("FixationMaps/{}_{}norm.txt", mesh, view),
                  lines(n_, [&](std::size_t i) { return sees(i) ? height(i) : 0; }));
      data_.write(fmt::format("CentricityAndVisibilityMaps/{}_{}_visibility.txt", mesh, view),
                  lines(n_, [&](std::size_t i) { return sees(i) ? 1 : 0; }));
    }
  }
  run_protocol("3dva");
  EXPECT_THAT(scored_items(),
              ElementsAre("bunny/300", "bunny/413", "bunny/599", "dragon/300", "dragon/413", "dragon/599"));
  EXPECT_THAT(inspection_.items, SizeIs(6));
  EXPECT_EQ(inspection_.n_shapes(), 2U);
  EXPECT_THAT(inspection_.unused, SizeIs(2)) << "the meshes that are turned upright";
  const auto n_seen = static_cast<std::size_t>(std::ranges::count(seen_599, true));
  EXPECT_EQ(inspection_.items[2].seen, n_seen);
  EXPECT_EQ(inspection_.items[2].points, n_);
  ScalarField heights;
  for (std::size_t i = 0; i < n_; ++i) heights.push_back(height(i));
  for (const ResultRow& row : toy_->results())
    if (row.model == "MC" && row.item == "bunny" && row.view == "599") {
      EXPECT_EQ(row.scores.n_points, static_cast<std::int64_t>(n_seen));
      EXPECT_NEAR(score(row, "cc"), correlation(map("MC", 2), heights, seen_599), 1e-9);
    }
}

TEST_F(Protocols, Sal3d) {
  for (const char* mesh : {"cat", "dog", "cow"})
    data_.write(fmt::format("Gaze/{}.txt", mesh), lines(n_, [&](std::size_t i) {
                  const Vec3& v = sphere_.vertices[i];
                  return fmt::format("{} {} {} {} {} {} {} {}", v.x(), v.y(), v.z(), 6 * v.x(), 6 * v.y(),
                                     6 * v.z(), std::abs(v.z()), std::abs(v.z()) > 0.9 ? 1 : 0);
                }));
  data_.write("splits.csv", "item,split\ncat,train\ndog,test\ncow,val\n");
  run_protocol("sal3d");
  EXPECT_THAT(scored_items(), ElementsAre("dog"));
  for (const ResultRow& row : toy_->results()) {
    EXPECT_EQ(std::pair(row.dataset, row.split), std::pair(std::string("clouds"), std::string("test")));
    EXPECT_TRUE(std::isfinite(score(row, "sim"))) << row.model;
  }
  EXPECT_THAT(inspection_.items, SizeIs(3));
  EXPECT_TRUE(inspection_.items[0].is_cloud);
  EXPECT_EQ(inspection_.items[0].seen, n_);
  EXPECT_GT(inspection_.items[0].picks, 0U);
}

TEST_F(Protocols, MeshMamba) {
  std::string paths;
  for (int k = 0; k < 5; ++k) {
    const std::string name = fmt::format("Apple_v0{}", k);
    paths += fmt::format("dataset/MeshFile/rgb_texture/Apple/{}.obj\n", name);
    for (const char* kind : {"non_texture", "rgb_texture"}) {
      data_.write(fmt::format("MeshFile/{}/Apple/{}.obj", kind, name), obj_text(sphere_));
      data_.write(fmt::format("SaliencyMap/{}/{}.csv", kind, name),
                  lines(sphere_.faces.size(), [](std::size_t f) { return f % 5; }));
    }
  }
  data_.write("paths_dataset_rgb.txt", paths);
  run_protocol("meshmamba");
  EXPECT_THAT(scored_items(), ElementsAre("Apple_v04"));
  EXPECT_EQ(inspection_.items[3].split, "train");
  EXPECT_THAT(inspection_.unused, SizeIs(10)) << "the textured half";
}

TEST_F(Protocols, Schelling) {
  write_toy_item(data_.path(), "21", sphere_);
  write_toy_item(data_.path(), "22", sphere_);
  const Config config = read_config(
      Section::from_file(std::string(SALBENCH_CONFIGS) + "/protocols/schelling.yaml"), "schelling");
  toy_ = std::make_unique<ToyRun>(data_.path(), store_, config);
  toy_->run();
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_THAT(scored_items(), ElementsAre("21", "22"));
  inspection_ = inspect_data(data_.path(), layouts_of(config.dataset.layout));
  EXPECT_EQ(inspection_.items[1].participants, 4U);
  EXPECT_EQ(inspection_.items[1].picks, 20U);
  EXPECT_THAT(inspection_.unused, IsEmpty());
}

TEST_F(Protocols, Zaragoza) {
  data_.write("Meshes/bimba.off", off_text(sphere_));
  data_.write("Distributions/bimba.val", lines(n_, [](std::size_t i) { return i % 7; }));
  data_.write("RawData/bimba_0.pid", "3\n10\n17\n");
  run_protocol("zaragoza");
  EXPECT_THAT(scored_items(), ElementsAre("bimba"));
  for (const ResultRow& row : toy_->results()) EXPECT_EQ(row.scores.n_picks, 3) << row.model;
  EXPECT_EQ(inspection_.items[0].high, 6);
}

TEST_F(Protocols, Dutagaci) {
  data_.write("MODEL_DATASET/ant.off", off_text(sphere_));
  std::vector<std::vector<double>> cells(10 * 11, std::vector<double>{1});
  cells[2 + 7 * 10] = {1, 12, 162};
  data_.write("GROUND_TRUTH_B/readme.txt", "");
  MatWriter(data_ / "GROUND_TRUTH_B/ant.mat").write_cells("GT_POINTS", 10, 11, cells);
  run_protocol("dutagaci");
  EXPECT_THAT(scored_items(), ElementsAre("ant"));
  EXPECT_THAT(inspection_.unused, ElementsAre((data_ / "GROUND_TRUTH_B/readme.txt").string()));
  EXPECT_EQ(inspection_.items[0].picks, 3U);
  for (const ResultRow& row : toy_->results()) {
    const double thirds = 3 * score(row, "fne");
    EXPECT_NEAR(thirds, std::round(thirds), 1e-12) << row.model;
    EXPECT_EQ(score(row, "wme"), score(row, "fne")) << row.model;
  }
}

// --- what is wrong ----------------------------------------------------------------------------------------

TEST_F(Protocols, AnInspectionNamesProblemsAndGoesOn) {
  for (const char* name : {"cat", "dog"})
    data_.write(fmt::format("off/{}.off", name), off_text(shapes::tetrahedron()));
  data_.write("maps/cat.val", "1\n2\n3\n");
  data_.write("maps/dog.val", "1\nnan\n3\n4\n");
  data_.write("maps/eel.val", "1\n");
  data_.write("notes/.hidden", "");
  data_.write("notes/readme.txt", "");
  const DataInspection found = inspect_data(
      data_.path(),
      layouts_of(description("places: [{meshes: 'off/*', truth: {saliency: 'maps/{item}.val'}}]\n"
                             "values: {unseen: nan}\n")));
  EXPECT_THAT(found.problems(),
              ElementsAre(fmt::format("cat: {}:3: the file has 3 values, but the mesh has 4 vertices",
                                      (data_ / "maps/cat.val").string()),
                          fmt::format("eel: ground truth without a mesh or point cloud ({})",
                                      (data_ / "maps/eel.val").string())));
  EXPECT_EQ(std::tuple(found.items[1].seen, found.items[1].low, found.items[1].high), std::tuple(3U, 1, 4));
  EXPECT_THAT(found.unused,
              ElementsAre((data_ / "maps/eel.val").string(), (data_ / "notes/readme.txt").string()));
}

}  // namespace
}  // namespace salbench
