// SPDX-License-Identifier: GPL-3.0-or-later
// A data set of point clouds in all their formats, beside a mesh, through every subcommand.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file.h"
#include "tests/e2e/workspace.h"
#include "tests/support/cloud_text.h"
#include "tests/support/exported_file.h"
#include "tests/support/toy_data.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

constexpr const char* kSome = "dataset: {scans: false}\nmodels: {PS: , MS: , RS: }\npicture: {size: 40}\n";

// The workspace's mesh "1", and the clouds "a.xyz", "b.pcd" (organised, with a gap) and "c.ply".
struct CloudWorkspace : Workspace {
  Mesh mesh = shapes::bumpy_sphere(2);

  CloudWorkspace() : Workspace(kSome) {
    fs::remove(data() / "Meshes/2.off");
    for (const char* name : {"a", "b", "c"}) write_toy_truth(data(), name, mesh);
    write("data set/Meshes/a.xyz", xyz_text(mesh.vertices));
    write("data set/Meshes/c.ply", ply_cloud_text(mesh.vertices, mesh_normals(mesh)));
    std::string body;
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
      body += i == 4 ? "nan nan nan\n" : xyz_text(std::span(&mesh.vertices[i], 1));
    write("data set/Meshes/b.pcd",
          "VERSION 0.7\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 81\nHEIGHT 2\n"
          "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 162\nDATA ascii\n" +
              body);
    for (int k = 0; k < 4; ++k) write(fmt::format("data set/RawData/b_{}.pid", k), "0\n161\n");
  }
};

TEST(CloudsCommand, RunScoresThemInTablesOfTheirOwn) {
  const CloudWorkspace toy;
  const Outcome run = toy.salbench("run");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("b: 1 of 162 points dropped: they have no position"));
  const auto rows = lines_with(toy.results(), "clouds,");
  ASSERT_THAT(rows, SizeIs(9));
  EXPECT_THAT(rows[0], AllOf(HasSubstr("clouds,a,,,PS,"), HasSubstr(",162,")));
  EXPECT_THAT(rows[4], AllOf(HasSubstr("clouds,b,,,MS,"), HasSubstr(",161,2")));
  EXPECT_THAT(lines_with(toy.summary(), "clouds,PS,auc,3"), SizeIs(1));
  EXPECT_TRUE(fs::exists(toy.out() / "mean_histograms_clouds.csv"));
  const std::string record = read_file(toy.out() / "run.yaml");
  EXPECT_THAT(record, AllOf(HasSubstr("meshes: 1, clouds: 3, files:"),
                            HasSubstr("{stage: map.PS, of: clouds, scope: cloud, items: 3, settled: 3,")));
  EXPECT_THAT(toy.salbench("plan").out, HasSubstr("\n0 jobs to do"));
  EXPECT_THAT(toy.salbench("plan").out, HasSubstr("data set: 1 meshes, 3 point clouds, 3 models"));
  EXPECT_THAT(toy.salbench("plan", {"b"}).out,
              AllOf(HasSubstr("cloud_normals"), Not(HasSubstr("to compute"))));
  const Outcome sound =
      run_process({SALBENCH_PROGRAM, "verify", toy.config().string(), "--data", toy.data().string(),
                   "--cache", toy.cache().string(), "--deep", "--sample", "100"});
  EXPECT_EQ(sound.status, 0) << sound.out << sound.err;
}

TEST(CloudsCommand, ARunWithoutCloudsLeavesNoTableOfThem) {
  const CloudWorkspace toy;
  ASSERT_EQ(toy.salbench("run").status, 0);
  ASSERT_EQ(toy.salbench("run", {"--items", "1"}).status, 0);
  EXPECT_FALSE(fs::exists(toy.out() / "mean_histograms_clouds.csv"));
  EXPECT_THAT(read_file(toy.out() / "run.yaml"), Not(HasSubstr("clouds")));
  EXPECT_THAT(lines_with(toy.results(), "clouds"), IsEmpty());
}

TEST(CloudsCommand, ATableOfAnEarlierRunThatCannotBeRemovedIsAnError) {
  const CloudWorkspace toy;
  toy.write("out/run.yaml", "program: salbench 1.0.0\n");
  fs::create_directories(toy.out() / "mean_histograms_clouds.csv/folder");
  const Outcome run = toy.salbench("run", {"--items", "1"});
  EXPECT_EQ(run.status, 3);
  EXPECT_THAT(run.err, HasSubstr("mean_histograms_clouds.csv: cannot be removed: "));
}

TEST(CloudsCommand, ExportHoldsThemWithTheirPictures) {
  const CloudWorkspace toy;
  const fs::path file = toy / "all.h5";
  const Outcome ended = toy.salbench("export", {"--to", file.string()});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const ExportedFile all(file);
  EXPECT_THAT(all.arrays(),
              AllOf(Contains("c/cloud/points"), Contains("c/cloud_normals/normals"),
                    Contains("c/surface/faces"), Contains("c/picture/primitive"),
                    Contains("means/reference/clouds/density"), Not(Contains("1/cloud/points"))));
  EXPECT_EQ(all.read("b/cloud/points").shape, (std::vector<std::size_t>{161, 3}));
  EXPECT_EQ(std::get<std::vector<std::int32_t>>(all.read("b/cloud/dropped").values),
            std::vector<std::int32_t>{4});
  EXPECT_EQ(all.read("b/cloud/viewpoint").shape, (std::vector<std::size_t>{1, 3}));
  EXPECT_EQ(all.read("c/cloud/viewpoint").shape, (std::vector<std::size_t>{0, 3}));
  EXPECT_EQ(toy.salbench("export", {"--to", (toy / "shapes").string(), "--format", "ply"}).status, 0);
  EXPECT_THAT(read_file(toy / "shapes/b.ply"), HasSubstr("element vertex 161\n"));
  EXPECT_THAT(read_file(toy / "shapes/a.ply"),
              AllOf(HasSubstr("nx"), HasSubstr("map_PS"), HasSubstr("picks")));
}

// One value per point that is left, as `maps` writes them, or per point of the file, as others do.
TEST(CloudsCommand, EvaluateTakesMapsOfThePointsLeftAndOfTheFiles) {
  const CloudWorkspace toy;
  ASSERT_EQ(
      toy.salbench("export", {"--format", "maps", "--models", "PS", "--to", (toy / "maps").string()}).status,
      0);
  const std::string left = read_file(toy / "maps/PS/b.val");
  EXPECT_EQ(std::count(left.begin(), left.end(), '\n'), 161);
  const auto scores = [&](const std::string& of_b) {
    write_file(toy / "maps/PS/b.val", of_b);
    const Outcome run = toy.salbench("run", {"--maps", (toy / "maps/PS").string(), "--name", "OWN"});
    EXPECT_EQ(run.status, 0) << run.err;
    return lines_with(toy.results(), "clouds,b,,,OWN");
  };
  const auto of_left = scores(left);
  ASSERT_THAT(of_left, SizeIs(1));
  std::size_t fifth = 0;
  for (int line = 0; line < 4; ++line) fifth = left.find('\n', fifth) + 1;
  EXPECT_EQ(scores(left.substr(0, fifth) + "77\n" + left.substr(fifth)), of_left);
  write_file(toy / "maps/PS/b.val", "1\n2\n");
  const Outcome wrong = toy.salbench("run", {"--maps", (toy / "maps/PS").string(), "--name", "OWN"});
  EXPECT_EQ(wrong.status, 1);
  EXPECT_THAT(wrong.err, HasSubstr("2 values, but the shape has 161 points"));
}

TEST(CloudsCommand, ACommandOfTheUsersGetsThePointsThatAreLeft) {
  const CloudWorkspace toy;
  toy.configure(
      "models:\n  LINES:\n    command: \"python3 -c 'import sys; n = [int(line.split()[2]) for line in "
      "open(sys.argv[1], "
      "errors=\\\"replace\\\") if line.startswith(\\\"element vertex\\\")][0]; open(sys.argv[2], "
      "\\\"w\\\").write("
      "\\\"\\\".join(str(i) + chr(10) for i in range(n)))' {mesh} {out}\"\n");
  const Outcome run = toy.salbench("run", {"--items", "b"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(lines_with(toy.results(), "clouds,b,,,LINES"), ElementsAre(HasSubstr(",161,2")));
}

TEST(CloudsCommand, TwoFilesOfOneNameAreAnError) {
  const CloudWorkspace toy;
  toy.write("data set/Meshes/1.xyz", xyz_text(toy.mesh.vertices));
  const Outcome refused = toy.salbench("run");
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("1.xyz have the same name: rename or remove one of them"));
}

TEST(CloudsCommand, FewAndRepeatedPointsAreNoTroubleToAnyModel) {
  const CloudWorkspace toy;
  toy.configure("dataset: {scans: false, participants: simulated}\n");
  toy.write("data set/Meshes/nine.xyz", xyz_text(shapes::random_cloud(9, 3)));
  std::string line;
  for (int i = 0; i < 40; ++i) line += fmt::format("{} 0 0\n", i);
  toy.write("data set/Meshes/line.xyz", line);
  toy.write("data set/Meshes/twice.xyz", xyz_text(toy.mesh.vertices) + xyz_text(toy.mesh.vertices));
  toy.write("data set/Meshes/places.xyz", std::string("0 0 0\n1 0 0\n0 1 0\n0 0 1\n") +
                                              "0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n");
  const Outcome run = toy.salbench("run", {"--items", "nine,line,twice,places"});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(lines_with(toy.results(), "clouds,"), SizeIs(4 * 5));
}

}  // namespace
}  // namespace salbench
