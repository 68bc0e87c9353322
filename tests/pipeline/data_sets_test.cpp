// SPDX-License-Identifier: GPL-3.0-or-later
// A generated miniature of the layout of each data set that a description names: none of the data is ours to
// publish. And what is said where a file does not fit its description.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/core/seen.h"
#include "stages/ground_truth/carried.h"
#include "tests/support/mat.h"
#include "tests/support/memory_store.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/toy_data.h"

namespace salbench {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::IsNan;
using testing::SizeIs;
using testing::StartsWith;
using testing::ThrowsMessage;

const Mesh kSphere = shapes::bumpy_sphere(2);

std::string obj_text(const Mesh& mesh) {
  std::string text;
  for (const Vec3& v : mesh.vertices) text += fmt::format("v {} {} {}\n", v.x(), v.y(), v.z());
  for (const Triangle& f : mesh.faces) text += fmt::format("f {} {} {}\n", f[0] + 1, f[1] + 1, f[2] + 1);
  return text;
}

// A value per vertex of another shape each time.
ScalarField heights(const Mesh& mesh, double offset) {
  ScalarField values;
  for (const Vec3& v : mesh.vertices) values.push_back(std::abs(v.z() + offset));
  return values;
}

std::string lines_of(const ScalarField& values) {
  std::string text;
  for (const double value : values) text += fmt::format("{}\n", value);
  return text;
}

class DataSets : public testing::Test {
 protected:
  // A run over a layout: what it makes of its items, or what it says.
  void run(const std::string& layout, const std::string& more = "scans: false") {
    toy_.reset();
    toy_ = std::make_unique<ToyRun>(
        data_.path(), store_,
        fmt::format("dataset: {{layout: {}, {}}}\nscan: {{step_degrees: 2}}\nmodels: {{RS: , HS: }}\n",
                    layout, more));
    toy_->run();
  }
  GroundTruth truth(std::size_t item = 0) const {
    return std::get<GroundTruth>(*toy_->runner.result({toy_->row("ground_truth"), Item::mesh(item)}));
  }
  std::vector<std::string> failures() const {
    std::vector<std::string> causes;
    for (const Failure& failure : toy_->runner.failures()) causes.push_back(failure.cause);
    return causes;
  }
  // Of a model and metric, over meshes or scans; NaN is undefined.
  double score_of(std::string_view model, std::string_view metric, bool scan = false) const {
    for (const ResultRow& row : toy_->results())
      if (row.model == model && !row.view.empty() == scan) return value_of(row.scores, metric);
    ADD_FAILURE() << "no scores of " << model;
    return 0;
  }
  std::string description(const std::string& yaml) { return folder_.write("own.yaml", yaml).string(); }

  TemporaryFolder data_, folder_;
  MemoryStore store_;
  std::unique_ptr<ToyRun> toy_;
};

// --- the descriptions of the program ----------------------------------------------------------------------

TEST_F(DataSets, Schelling) {
  write_toy_item(data_.path(), "21", kSphere);
  for (const char* layout : {"schelling", "automatic"}) {
    run(layout);
    EXPECT_THAT(failures(), IsEmpty());
    EXPECT_THAT(truth().picks, SizeIs(4));
    EXPECT_EQ(toy_->workload.families[0].source.category, "cup");
    EXPECT_TRUE(std::isfinite(score_of("HS", "nss")));
  }
}

TEST_F(DataSets, Gs) {
  data_.write("off/1.off", off_text(kSphere));
  data_.write("GS/Saliency/1.val", lines_of(heights(kSphere, 0)));
  data_.write("GS/RawData/1_0.pid", "0\n3\n");
  run("gs");
  EXPECT_EQ(truth().saliency, heights(kSphere, 0));
  EXPECT_THAT(truth().picks, ElementsAre(ElementsAre(0, 3)));
}

TEST_F(DataSets, Princeton) {
  data_.write("MeshsegBenchmark-1.0/data/off/400.off", off_text(kSphere));
  data_.write("SchellingData/Distributions/400.val", lines_of(heights(kSphere, 0)));
  run("princeton");
  EXPECT_EQ(truth().saliency, heights(kSphere, 0));
  EXPECT_EQ(toy_->workload.families[0].source.category, "four-legged");
}

TEST_F(DataSets, Folder) {
  data_.write("horse.off", off_text(kSphere));
  run("folder");
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_THAT(toy_->workload.families[0].truth_files, IsEmpty()) << "ground truth is optional";
}

TEST_F(DataSets, Dutagaci) {
  data_.write("MODEL_DATASET/ant.off", off_text(kSphere));
  data_.write("GROUND_TRUTH_B/readme.txt", "");
  std::vector<std::vector<double>> cells(10 * 11, std::vector<double>{1});
  cells[2 + 7 * 10] = {1, 12, 162};  // row 3, column 8
  MatWriter(data_ / "GROUND_TRUTH_B/ant.mat").write_cells("GT_POINTS", 10, 11, cells);
  run("dutagaci");
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_THAT(truth().picks, ElementsAre(ElementsAre(0, 11, 161)));
  EXPECT_TRUE(std::isfinite(score_of("RS", "nss")));
}

TEST_F(DataSets, ThreeDva) {
  data_.write("Meshes/bunny.off", off_text(kSphere));
  ScalarField front = heights(kSphere, 0), back = heights(kSphere, 0.5);
  for (std::size_t i = 0; i < front.size(); ++i) {
    if (kSphere.vertices[i].z() < 0) front[i] = -1;
    if (kSphere.vertices[i].z() > -0.5) back[i] = -1;
  }
  data_.write("FixationMaps/bunny_view1.txt", lines_of(front));
  data_.write("FixationMaps/bunny_view2.txt", lines_of(back));
  run("3dva", "scans: true");
  EXPECT_THAT(failures(), IsEmpty());
  std::int64_t seen = 0;
  for (std::size_t i = 0; i < front.size(); ++i) {
    const double z = kSphere.vertices[i].z();
    if (z > -0.5 && z < 0) {
      EXPECT_THAT(truth().saliency[i], IsNan()) << "no view shows it";
    } else {
      EXPECT_EQ(truth().saliency[i], z < 0 ? back[i] : front[i]);
      ++seen;
    }
  }
  EXPECT_THAT(truth().viewers, IsEmpty()) << "views are no viewers";
  EXPECT_LT(seen, std::ssize(front));
  for (const ResultRow& row : toy_->results()) {
    if (row.view.empty()) {
      EXPECT_EQ(row.scores.n_points, seen);
    }
    EXPECT_TRUE(std::isfinite(value_of(row.scores, "cc"))) << row.item << " " << row.view;
  }
}

TEST_F(DataSets, Sal3d) {
  data_.write("Models_3D/cat.obj", obj_text(kSphere));
  std::string text;
  for (std::size_t i = 0; i < kSphere.vertices.size(); ++i) {
    const Vec3& v = kSphere.vertices[i];
    if (v.x() < -0.5) continue;  // not sampled
    text += fmt::format("{:.18e} {:.18e} {:.18e} 0.0 0.0 1.0 {} {}\n", v.x(), v.y(), v.z() * 1.0001,
                        0.5 + 0.1 * static_cast<double>(i % 4), i % 4 > 2 ? 1 : 0);
  }
  data_.write("dataset_train/cat.txt", text);
  run("sal3d");
  EXPECT_THAT(failures(), IsEmpty());
  for (std::size_t i = 0; i < kSphere.vertices.size(); ++i) {
    const double x = kSphere.vertices[i].x();
    if (x < -0.6) {
      EXPECT_THAT(truth().saliency[i], IsNan());
    }
    if (x >= -0.5) {
      EXPECT_EQ(truth().saliency[i], 0.5 + 0.1 * static_cast<double>(i % 4));
    }
  }
  EXPECT_TRUE(std::isfinite(score_of("RS", "cc")));
}

TEST_F(DataSets, MeshMamba) {
  // A face that is dropped, since it has no area, has its line all the same.
  Mesh mesh = kSphere;
  mesh.faces.insert(mesh.faces.begin(), {0, 0, 1});
  ScalarField values;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    values.push_back(f == 0 ? 77 : static_cast<double>(f % 5));
  for (const std::string kind : {"non_texture", "rgb_texture"}) {
    data_.write("MeshFile/" + kind + "/Apple_Red/Apple_v01.obj", obj_text(mesh));
    data_.write("MeshFile/" + kind + "/Apple_Red/Apple_v01.obj.meta", "");
    data_.write("SaliencyMap/" + kind + "/Apple_v01.csv", lines_of(values));
    for (double& value : values) value += 1;
  }
  const ScalarField on_vertices = vertex_values_of_faces(
      kSphere.vertices, kSphere.faces, std::vector<double>(values.begin() + 1, values.end()));
  run("meshmamba_textured");
  EXPECT_THAT(failures(), IsEmpty());
  for (std::size_t i = 0; i < on_vertices.size(); ++i)
    EXPECT_NEAR(truth().saliency[i], on_vertices[i] - 1, 1e-12);
  run("meshmamba");
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_EQ(toy_->workload.families[0].source.name, "Apple_v01");
  for (std::size_t i = 0; i < on_vertices.size(); ++i)
    EXPECT_NEAR(truth().saliency[i], on_vertices[i] - 2, 1e-12);
  EXPECT_TRUE(std::isfinite(score_of("RS", "cc")));
}

// --- viewers ----------------------------------------------------------------------------------------------

constexpr const char* kViewers =
    "places: [{meshes: 'off/*', truth: {saliency: 'maps/{item}_{viewer}.csv'}}]\n";

TEST_F(DataSets, ViewersMakeTheGroundTruthAndHumanPerformance) {
  data_.write("off/cat.off", off_text(kSphere));
  for (int k = 0; k < 5; ++k)
    data_.write(fmt::format("maps/cat_{}.csv", k), lines_of(heights(kSphere, 0.1 * k)));
  run(description(kViewers));
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_THAT(truth().viewers, SizeIs(5));
  EXPECT_EQ(truth().viewers[3], heights(kSphere, 0.1 * 3));
  EXPECT_EQ(truth().saliency, mean_of_seen(truth().viewers, std::vector<std::size_t>{0, 1, 2, 3, 4}));
  EXPECT_GT(score_of("HS", "cc"), 0.5) << "people who see much the same agree";
  EXPECT_THAT(score_of("HS", "nss"), IsNan()) << "nobody picked a point";
}

TEST_F(DataSets, OneViewerIsNoHumanPerformance) {
  data_.write("off/cat.off", off_text(kSphere));
  data_.write("maps/cat_0.csv", lines_of(heights(kSphere, 0)));
  run(description(kViewers));
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_THAT(truth().viewers, IsEmpty());
  EXPECT_EQ(truth().saliency, heights(kSphere, 0));
}

// --- keys -------------------------------------------------------------------------------------------------

TEST_F(DataSets, HowFilesAreReadIsPartOfTheKeyUnlessItIsAsEver) {
  write_toy_item(data_.path(), "21", kSphere);
  const auto names = [&](const std::string& yaml) {
    run(yaml.empty() ? "schelling" : description(yaml));
    std::vector<std::string> found;
    for (const SourceFile& file : toy_->workload.families[0].truth_files) found.push_back(file.name);
    return found;
  };
  const std::string places =
      "places: [{meshes: 'Meshes/*', truth: {saliency: 'Distributions/{item}.val', picks: "
      "'RawData/{item}_{participant}.pid'}}]\n";
  const auto as_ever = names("");
  EXPECT_THAT(as_ever, ElementsAre("saliency file", "picks 0", "picks 1", "picks 2", "picks 3"));
  EXPECT_EQ(names(places), as_ever);
  store_.take_saved();
  run(description(places));
  EXPECT_THAT(store_.take_saved(), IsEmpty()) << "what the program's own description led to is found";
  EXPECT_THAT(names(places + "values: {column: 1, unseen: -1}\n")[0],
              "saliency file (column: 1, unseen: \"-1\")");
}

// --- what does not fit ------------------------------------------------------------------------------------

class BadData : public DataSets {
 protected:
  BadData() {
    data_.write("off/cat.off", off_text(shapes::tetrahedron()));
    data_.write("off/dog.off", off_text(shapes::tetrahedron()));
    data_.write("maps/dog.csv", "1\n2\n3\n4\n");
  }
  std::string place(const std::string& name) const { return (data_ / name).string(); }
};

constexpr const char* kMaps = "places: [{meshes: 'off/*', truth: {saliency: 'maps/{item}.csv'}}]\n";

TEST_F(BadData, AGlobThatFitsNothingIsNamedWithItsLine) {
  const std::string own =
      description("# own\nplaces:\n  - meshes: of/*.off\n    truth:\n      saliency: maps/{item}.csv\n");
  EXPECT_THAT([&] { run(own); },
              ThrowsMessage<InputError>(fmt::format(
                  "{}: no .off, .obj or .ply meshes found, and no .ply, .pcd or .xyz point clouds; "
                  "looked in own: {} ({}:3)",
                  data_.path().string(), place("of/*.off"), own)));
  const std::string other =
      description("places:\n  - meshes: off/*.off\n    truth:\n      saliency: maps/{item}.val\n");
  EXPECT_THAT([&] { run(other); },
              ThrowsMessage<InputError>(
                  fmt::format("{}:4: 'maps/{{item}}.val' fits no file of an item; expected are such as {}",
                              other, place("maps/{item}.val"))));
  const std::string absent = description(
      "places:\n  - meshes: off/*.off\n    truth:\n      picks: clicks/{item}_{participant}.pid\n");
  EXPECT_THAT([&] { run(absent); }, ThrowsMessage<InputError>(StartsWith(absent + ":4: 'clicks/")));
}

TEST_F(BadData, AWrongCountFailsItsItemAlone) {
  data_.write("maps/cat.csv", "1\n2\n3\n");
  run(description(kMaps));
  EXPECT_THAT(failures(),
              ElementsAre(place("maps/cat.csv") + ":3: the file has 3 values, but the mesh has 4 vertices"));
  EXPECT_THAT(truth(1).saliency, ElementsAre(1, 2, 3, 4));
  data_.write("maps/cat.csv", "1\n2\n3\n");
  data_.write("maps/dog.csv", "1\n2\n3\n4\n5\n");
  run(description(std::string(kMaps) + "values: {per: face}\n"));
  EXPECT_THAT(failures(),
              ElementsAre(place("maps/cat.csv") + ":3: the file has 3 values, but the mesh has 4 faces",
                          place("maps/dog.csv") + ":5: the file has 5 values, but the mesh has 4 faces"));
}

TEST_F(BadData, AWrongColumnIsNamedWithThoseThatThereAre) {
  data_.write("maps/cat.csv", "id,density\n0,1\n1,2\n2,3\n3,4\n");
  data_.write("maps/dog.csv", "0;1\n1;2\n2;3\n3\n");
  run(description(std::string(kMaps) + "values: {column: saliency}\n"));
  EXPECT_THAT(
      failures(),
      ElementsAre(place("maps/cat.csv") + ":1: no column \"saliency\": the header has \"id\", \"density\"",
                  place("maps/dog.csv") +
                      ":1: no column \"saliency\": the first line has numbers, not names of columns"));
  run(description(std::string(kMaps) + "values: {column: 2}\n"));
  EXPECT_THAT(truth(0).saliency, ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(failures(),
              ElementsAre(place("maps/dog.csv") + ":4: the line has 1 column, expected column 2"));
}

TEST_F(BadData, AWrongBaseIsNamed) {
  data_.write("clicks/cat_0.pid", "4\n1\n");
  data_.write("clicks/dog_0.pid", "1\n0\n");
  const std::string clicks =
      "places: [{meshes: 'off/*', truth: {picks: 'clicks/{item}_{participant}.pid'}}]\n";
  run(description(clicks));
  EXPECT_THAT(failures(),
              ElementsAre(place("clicks/cat_0.pid") +
                          ":1: vertex 4 is out of range: the mesh has 4 vertices, numbered from 0"));
  run(description(clicks + "indices: {base: 1}\n"));
  EXPECT_THAT(truth(0).picks, ElementsAre(ElementsAre(3, 0)));
  EXPECT_THAT(failures(),
              ElementsAre(place("clicks/dog_0.pid") +
                          ":2: vertex 0 is out of range: the mesh has 4 vertices, numbered from 1"));
}

TEST_F(BadData, PicksOfAMatFileAreVerticesToo) {
  data_.write("maps/readme.txt", "");
  MatWriter(data_ / "maps/cat.mat").write("points", {1, 2.5});
  MatWriter(data_ / "maps/dog.mat").write("points", {4, 0});
  const std::string mats = "places: [{meshes: 'off/*', truth: {picks: 'maps/{item}.mat'}}]\n";
  run(description(mats + "indices: {base: 1, variable: points}\n"));
  EXPECT_THAT(failures(),
              ElementsAre(place("maps/cat.mat") +
                              ": points: pick 2 (from 1) is 2.5: the mesh has 4 vertices, numbered from 1",
                          place("maps/dog.mat") +
                              ": points: pick 2 (from 1) is 0: the mesh has 4 vertices, numbered from 1"));
  run(description(mats));
  EXPECT_THAT(failures(), Each(HasSubstr("the description names no `variable:` in it")));
}

TEST_F(BadData, TwoFilesWhereOneIsMeantAreNamed) {
  data_.write("more_maps/dog.csv", "1\n2\n3\n4\n");
  EXPECT_THAT(
      [&] { run(description("places: [{meshes: 'off/*', truth: {saliency: '*maps/{item}.csv'}}]\n")); },
      ThrowsMessage<InputError>(AllOf(StartsWith(place("more_maps/dog.csv") + ": dog has a file already, "),
                                      HasSubstr("own.yaml:1 means one: keep one of them"))));
}

TEST_F(BadData, PointsFarFromTheMeshAreNoValues) {
  data_.write("maps/cat.csv", "x,y,z,s\n100,100,100,1\n");
  data_.write("maps/dog.csv", "x,y,z,s\n");
  run(description(std::string(kMaps) + "values: {per: point, points: [x, y, z], column: s}\n"));
  EXPECT_THAT(failures(), ElementsAre(HasSubstr("cat.csv: no point of the shape has a value; expected are"),
                                      HasSubstr("dog.csv:1: the file has no values")));
}

TEST_F(BadData, AParticipantWithoutPicksCountsAndNobodysPicksAreAnError) {
  data_.write("clicks/cat_0.pid", "3\n");
  data_.write("clicks/cat_1.pid", "");
  data_.write("clicks/dog_0.pid", "");
  data_.write("clicks/dog_1.pid", "");
  run(description("places: [{meshes: 'off/*', truth: {picks: 'clicks/{item}_{participant}.pid'}}]\n"));
  EXPECT_THAT(truth(0).picks, ElementsAre(ElementsAre(3), IsEmpty()));
  EXPECT_THAT(failures(),
              ElementsAre(HasSubstr("dog_0.pid: nobody picked a point and there is no saliency file; "
                                    "remove the empty .pid files")));
}

TEST_F(BadData, NumpyFilesAreReadToo) {
  std::string npy = std::string("\x93NUMPY\x01\x00", 8) + std::string("\x46\x00", 2) +
                    "{'descr': '<f8', 'fortran_order': False, 'shape': (4,), }           \n";
  npy.resize(10 + 0x46, ' ');
  for (const double value : {1.0, -1.0, 3.0, 4.0})
    npy.append(reinterpret_cast<const char*>(&value), sizeof value);
  data_.write("maps/cat.csv", npy);
  run(description(std::string(kMaps) + "values: {unseen: -1}\n"));
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_THAT(truth(0).saliency, ElementsAre(1, IsNan(), 3, 4));
  run(description(std::string(kMaps) + "values: {per: point, points: [x, y, z], column: s}\n"));
  EXPECT_THAT(failures(), Contains(HasSubstr("cat.csv: values per point stand in columns beside x, y and z: "
                                             "write them as text")));
}

}  // namespace
}  // namespace salbench
