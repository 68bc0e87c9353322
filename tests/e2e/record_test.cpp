// SPDX-License-Identifier: GPL-3.0-or-later
// run.yaml says what was run: on which data, with which folders.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cache/recipes.h"
#include "io/file.h"
#include "io/table.h"
#include "pipeline/config/section.h"
#include "tests/e2e/workspace.h"
#include "tests/support/cache_files.h"
#include "tests/support/text_column.h"
#include "tests/support/toy_data.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

std::string data_line(const Workspace& toy, const std::vector<std::string>& further = {}) {
  EXPECT_EQ(toy.salbench("run", further).status, 0);
  const auto lines = lines_with(read_file(toy.out() / "run.yaml"), "data_set: ");
  EXPECT_THAT(lines, SizeIs(1));
  return lines.at(0);
}

std::string digest_in(const std::string& line) { return line.substr(line.find("digest: ") + 8, 32); }

TEST(Record, IdentifiesTheDataByItsContent) {
  const Workspace toy(kMeshesOnly);
  const std::string line = data_line(toy);
  EXPECT_THAT(line, HasSubstr("folder: \"" + toy.data().string() + "\""));
  EXPECT_THAT(line, HasSubstr("layout: schelling, meshes: 2, files: 12, "))
      << "2 x (mesh, saliency, 4 participants)";
  EXPECT_THAT(line, HasSubstr(", participants: [4, 4]}"));
  const fs::path last = toy.data() / "RawData/2_3.pid", aside = toy / "2_3.pid";
  fs::rename(last, aside);
  EXPECT_THAT(data_line(toy), HasSubstr(", participants: [3, 4]}"));
  fs::rename(aside, last);
  const fs::path elsewhere = toy / "copy";
  fs::copy(toy.data(), elsewhere, fs::copy_options::recursive);
  EXPECT_EQ(digest_in(data_line(toy, {"--data", elsewhere.string()})), digest_in(line)) << "wherever it lies";
  EXPECT_NE(digest_in(data_line(toy, {"--items", "1"})), digest_in(line));
  toy.write("copy/RawData/2_1.pid", "3\n");
  EXPECT_NE(digest_in(data_line(toy, {"--data", elsewhere.string()})), digest_in(line));
}

// The recorded configuration alone, without any folder on the command line, is the same run.
TEST(Record, TheConfigurationRepeatsTheRunInItsFolders) {
  const Workspace toy(
      "protocol: text\nseed: 9\nscan: {step_degrees: 2}\nmodels: {RS: , PS: {absolute: false}}\n");
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::string results = toy.results(), record = read_file(toy.out() / "run.yaml");
  std::string yaml;
  for (const std::string& line : lines_with(record.substr(record.find("\nconfiguration:\n") + 1), "  "))
    yaml += line.substr(2) + "\n";
  toy.configure(yaml);
  fs::remove_all(toy.out());
  const Outcome again = run_process({SALBENCH_PROGRAM, "run", toy.config().string()});
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(toy.computed(), 0U);
  EXPECT_EQ(toy.results(), results);
}

// Two quadrilaterals beside a sphere, an arrow among them, all of it far from the origin.
// Returns its distance from the origin, in diagonals of its bounding box.
double write_odd_item(const fs::path& data, const std::string& name) {
  Mesh mesh = shapes::bumpy_sphere(2, 0.35);
  const auto n = static_cast<std::int32_t>(mesh.vertices.size());
  for (const Vec3& v : {Vec3(2, 0, 0), Vec3(3, 0, 0), Vec3(3, 1, 0), Vec3(2, 1, 0)})
    mesh.vertices.push_back(v);
  for (const Vec3& v : {Vec3(4, 0, 0), Vec3(6, 1, 0), Vec3(4, 2, 0), Vec3(5, 1, 0)})
    mesh.vertices.push_back(v);
  for (Vec3& v : mesh.vertices) v.y() += 1e5;
  write_toy_item(data, name, mesh);
  std::string text = off_text(mesh);
  const std::string counts = fmt::format("{} {}", mesh.vertices.size(), mesh.faces.size());
  text.replace(text.find(counts), counts.size(),
               fmt::format("{} {}", mesh.vertices.size(), mesh.faces.size() + 2));
  for (const int first : {n, n + 4})
    text += fmt::format("4 {} {} {} {}\n", first, first + 1, first + 2, first + 3);
  write_file(data / "Meshes" / (name + ".off"), text);
  Eigen::AlignedBox3d box;
  for (const Vec3& v : mesh.vertices) box.extend(v);
  return box.max().y() / box.diagonal().norm();
}

TEST(Record, HasOneRemarkPerOddShapeWhetherItWasReadNowOrBefore) {
  const Workspace toy(kMeshesOnly);
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_THAT(lines_with(read_file(toy.out() / "run.yaml"), "remark"), ElementsAre("remarks: []"));

  const double away = write_odd_item(toy.data(), "2");
  const Outcome run = toy.salbench("run");
  ASSERT_EQ(run.status, 0) << run.err;
  const std::string remark = fmt::format(
      "2 polygons split into triangles, 1 of them concave; coordinates reach {:.3g} diagonals of the "
      "bounding "
      "box from the origin: single precision has {:.3g} steps across the shape",
      away, (1 << 24) / away);
  EXPECT_THAT(lines_with(run.err, "warning: 2: " + remark), SizeIs(1)) << run.err;
  const auto expect_remark = [&] {
    EXPECT_THAT(lines_with(read_file(toy.out() / "run.yaml"), "remark:"),
                ElementsAre("  - {item: \"2\", remark: \"" + remark + "\"}"));
  };
  expect_remark();

  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_EQ(toy.computed(), 0U);
  expect_remark();
  const std::string cache = toy.cache().string();
  ASSERT_EQ(toy.salbench("gc").status, 0);
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_EQ(toy.computed(), 0U);
  expect_remark();
  EXPECT_EQ(run_process({SALBENCH_PROGRAM, "verify", "--cache", cache}).status, 0);
}

TEST(Record, MemoryIsThatOfTheRunAndNotOfWhatStartedIt) {
  const auto peak = [] {
    const Workspace toy(kMeshesOnly);
    EXPECT_EQ(toy.salbench("run").status, 0);
    return std::stod(*Section::from_file((toy.out() / "run.yaml").string()).text("peak_memory_mb"));
  };
  const double alone = peak();
  const std::vector<char> held(400'000'000, 1);
  EXPECT_LT(peak(), alone + 200);
  EXPECT_EQ(held.back(), 1);
}

TEST(Record, TellsMemoryAndCache) {
  const Workspace toy(kMeshesOnly);
  const Outcome ended = toy.salbench("run");
  ASSERT_EQ(ended.status, 0);
  EXPECT_THAT(ended.out,
              testing::EndsWith("to make a report of them: salbench report " + toy.out().string() + "\n"));
  const Section record = Section::from_file((toy.out() / "run.yaml").string());
  EXPECT_GT(std::stod(record.text("peak_memory_mb").value_or("0")), 5);
  EXPECT_GT(std::stod(record.child("hdf5_seconds").text("held").value_or("0")), 0)
      << "artefacts were written";
  EXPECT_GE(std::stod(record.child("hdf5_seconds").text("waited").value_or("-1")), 0);
  std::uintmax_t bytes = 0;
  for (const KnownArtefact& known : artefacts_of(toy.cache()))
    if (known.stage == "fpfh") bytes += bytes_of(*read_artefact(known));
  EXPECT_EQ(record.child("cache_bytes").text("fpfh"), std::to_string(bytes));
  // Run again, nothing is computed, and the artefacts are still those of the run.
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_EQ(Section::from_file((toy.out() / "run.yaml").string()).child("cache_bytes").text("fpfh"),
            std::to_string(bytes));
  EXPECT_THAT(toy.salbench("run", {"--quiet"}).out, IsEmpty());
}

}  // namespace
}  // namespace salbench
