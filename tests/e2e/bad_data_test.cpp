// SPDX-License-Identifier: GPL-3.0-or-later
// Data that cannot be used costs its own item and no other, and says in one line what is wrong where. Data
// that is merely odd goes on, with a warning.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file.h"
#include "io/table.h"
#include "tests/e2e/workspace.h"
#include "tests/support/job_counts.h"
#include "tests/support/text_column.h"
#include "tests/support/toy_data.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

std::vector<std::string> scored_items(const Workspace& toy) {
  return text_column(read_csv(toy.out() / "results.csv"), "item");
}

// Replaces one line of a file; lines count from 1.
void replace_line(const fs::path& file, int line, std::string_view by) {
  const std::string text = read_file(file);
  std::size_t begin = 0;
  for (int i = 1; i < line; ++i) begin = text.find('\n', begin) + 1;
  write_file(file, text.substr(0, begin) + std::string(by) + text.substr(text.find('\n', begin)));
}

const char* const kMesh = "Meshes/2.off";
const char* const kSaliency = "Distributions/2.val";
const char* const kPicks = "RawData/2_1.pid";

struct BadData {
  const char* name;
  void (*ruin)(const fs::path& data);
  std::vector<std::string> said;
};
void PrintTo(const BadData& param, std::ostream* out) { *out << param.name; }

// Sets name their items in their artefacts, line by line.
TEST(OddNames, OfItemsAreReadBackFromTheCache) {
  const Workspace toy(kMeshesOnly);
  const std::vector<std::string> names = {"line\nbreak", "\r\n", "tab\t", "\x1b[31m", "a: b", "C:\\con "};
  for (const std::string& name : names) write_toy_item(toy.data(), name, shapes::bumpy_sphere(2));
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_THAT(scored_items(toy), testing::IsSupersetOf(names));
  const std::string results = toy.results();
  const Outcome again = toy.salbench("run");
  EXPECT_EQ(again.status, 0);
  EXPECT_THAT(again.err, testing::Not(HasSubstr("warning: "))) << again.err;
  EXPECT_EQ(toy.computed(), 0U);
  EXPECT_EQ(toy.results(), results);
  const Outcome verified = run_process({SALBENCH_PROGRAM, "verify", "--cache", toy.cache().string()});
  EXPECT_EQ(verified.status, 0) << verified.out;
}

class BadItem : public testing::TestWithParam<BadData> {};

TEST_P(BadItem, IsNamedInOneLineAndTheOthersAreScored) {
  const Workspace toy(kMeshesOnly);
  GetParam().ruin(toy.data());
  const Outcome run = toy.salbench("run");
  EXPECT_EQ(run.status, 1) << run.err;
  const std::vector<std::string> errors = lines_with(run.err, "error: ");
  ASSERT_THAT(errors, SizeIs(1)) << run.err;
  EXPECT_THAT(errors[0], HasSubstr("error: 2: "));
  for (const std::string& part : GetParam().said) EXPECT_THAT(errors[0], HasSubstr(part));
  EXPECT_THAT(run.err, HasSubstr("\n1 failed, each named above: "));
  EXPECT_THAT(scored_items(toy), ElementsAre("1", "1"));

  // Mended, the item is taken up again.
  write_toy_item(toy.data(), "2", shapes::bumpy_sphere(2, 0.35));
  EXPECT_EQ(toy.salbench("run").status, 0);
  EXPECT_THAT(scored_items(toy), ElementsAre("1", "1", "2", "2"));
}

// The meshes have 162 vertices and 320 faces: vertices from line 3, faces from line 165.
const BadData kBadData[] = {
    {"MeshIsADanglingLink",
     [](const fs::path& data) {
       fs::remove(data / kMesh);
       fs::create_symlink("no such file", data / kMesh);
     },
     {"2.off", "cannot be read"}},
    {"IndexOutOfRange",
     [](const fs::path& data) { replace_line(data / kMesh, 165, "3 0 1 162"); },
     {"2.off:165: ", "162"}},
    {"HugeCoordinate",
     [](const fs::path& data) { replace_line(data / kMesh, 5, "1e300 0 0"); },
     {"2.off:5: ", "1e50"}},
    {"SaliencyOfAnotherMesh",
     [](const fs::path& data) { write_file(data / kSaliency, "0.5\n1\n"); },
     {"2.val", "2 values", "162 vertices"}},
    {"PickOutOfRange",
     [](const fs::path& data) { write_file(data / kPicks, "3\n162\n"); },
     {"2_1.pid:2: ", "162"}},
    {"SparseMesh",
     [](const fs::path& data) { fs::resize_file(data / kMesh, std::uintmax_t{10} << 30U); },
     {"2.off: 10737418240 bytes: at most 2147483648"}},
    {"DecimalCommaInACoordinate",
     [](const fs::path& data) { replace_line(data / kMesh, 3, "0,5 0 0"); },
     {"2.off:3: \"0,5\" is not a number: write its decimal comma as a point"}},
};
INSTANTIATE_TEST_SUITE_P(BadData, BadItem, testing::ValuesIn(kBadData),
                         [](const auto& test) { return test.param.name; });

TEST(BadData, NothingUsableAtAllIsStillNoCrash) {
  const Workspace toy;
  for (const char* mesh : {"1", "2"})
    write_file(toy.data() / "Meshes" / (std::string(mesh) + ".off"), "OFF\n");
  const Outcome run = toy.salbench("run");
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(lines_with(run.err, "error: "), SizeIs(2)) << run.err;
  EXPECT_THAT(scored_items(toy), IsEmpty());
}

// The mesh's vertices stay as they are, and with them the ground truth.
Mesh odd_mesh() {
  Mesh mesh = shapes::bumpy_sphere(2, 0.35);
  mesh.faces.push_back({5, 5, 9});      // degenerate
  mesh.faces.push_back(mesh.faces[0]);  // twice the same
  mesh.vertices.push_back({2, 2, 2});   // in no face
  const auto n = static_cast<std::int32_t>(mesh.vertices.size());
  for (const Vec3& v : shapes::tetrahedron().vertices) mesh.vertices.push_back(0.2 * v + Vec3(3, 0, 0));
  for (const Triangle& f : shapes::tetrahedron().faces) mesh.faces.push_back({f[0] + n, f[1] + n, f[2] + n});
  return mesh;
}

TEST(OddData, DegenerateAndDuplicateFacesPiecesAndLooseVerticesAreWarningsOnly) {
  const Workspace toy;
  write_toy_item(toy.data(), "2", odd_mesh());
  const Outcome run = toy.salbench("run");
  EXPECT_EQ(run.status, 0) << run.err;
  for (const char* what : {"1 degenerate face", "1 duplicate face", "1 isolated", "2 connected components"})
    EXPECT_THAT(lines_with(run.err, std::string("warning: 2: ") + what), SizeIs(1)) << run.err;
  EXPECT_THAT(scored_items(toy), SizeIs(JobCounts().of_kind("scores")));
  EXPECT_THAT(read_file(toy.out() / "run.yaml"),
              HasSubstr("{item: \"2\", remark: \"1 isolated vertices kept: no face uses them, the first is "
                        "vertex 162 (0-based); R is 3.41 with them and 3.16 without"));
}

// It is named with what it does.
TEST(OddData, ALooseVertexFarAwayIsNamedWithTheExtentThatItMakes) {
  const Workspace toy(kMeshesOnly);
  Mesh mesh = shapes::sphere(2);
  mesh.vertices.insert(mesh.vertices.begin() + 7, {9, 0, 0});
  for (Triangle& face : mesh.faces)
    for (std::int32_t& i : face) i += i >= 7 ? 1 : 0;
  write_toy_item(toy.data(), "2", mesh);
  ASSERT_EQ(toy.salbench("run").status, 0);
  for (int run = 0; run < 2; ++run) {  // the second finds it in the cache
    EXPECT_THAT(
        read_file(toy.out() / "run.yaml"),
        HasSubstr(
            "1 isolated vertices kept: no face uses them, the first is vertex 7 (0-based); R is 8.94 with "
            "them and 1 without, and maps depend on it: remove them"));
    ASSERT_EQ(toy.salbench("run").status, 0);
    EXPECT_EQ(toy.computed(), 0U);
  }
}

TEST(OddData, AParticipantWhoPickedNothingCountsForNothing) {
  const Workspace toy(kMeshesOnly);
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::string with_picks = toy.results();
  write_file(toy.data() / kPicks, "");
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::string picked_nothing = toy.results();
  fs::remove(toy.data() / kPicks);
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_EQ(toy.results(), picked_nothing);
  EXPECT_NE(toy.results(), with_picks);
}

TEST(OddData, WithoutAnyPickThereIsNoAucAndNoNssButACorrelation) {
  const Workspace toy(kMeshesOnly);
  for (int k = 0; k < 4; ++k) write_file(toy.data() / fmt::format("RawData/2_{}.pid", k), "");
  const Outcome run = toy.salbench("run");
  ASSERT_EQ(run.status, 0) << run.err;
  const Table results = read_csv(toy.out() / "results.csv");
  for (const char* column : {"auc", "auc_exact", "nss"}) {
    EXPECT_FALSE(std::isnan(number_column(results, column)[0])) << column;
    EXPECT_TRUE(std::isnan(number_column(results, column)[2])) << column;
  }
  EXPECT_FALSE(std::isnan(number_column(results, "cc")[2]));
  EXPECT_EQ(number_column(results, "n_picks")[2], 0);
  const Table summary = read_csv(toy.out() / "summary.csv");
  EXPECT_THAT(number_column(summary, "n"), ElementsAre(1, 1, 1, 2, 2, 1, 1, 1, 2, 2));
}

// Two specks far apart: the camera stands close, by the small area, and its rays pass between them.
TEST(BadData, AMeshThatNoRayMeetsKeepsItsOwnScores) {
  const Workspace toy;
  Mesh specks;
  for (const double x : {-1.0, 1.0})
    for (const Vec3& corner : {Vec3(x, 0, 0), Vec3(x, 1e-3, 0), Vec3(x, 0, 1e-3)})
      specks.vertices.push_back(corner);
  specks.faces = {{0, 1, 2}, {3, 4, 5}};
  write_toy_item(toy.data(), "2", specks);
  const Outcome run = toy.salbench("run");
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(lines_with(run.err, "error: 2_"), AllOf(SizeIs(kViews), Each(HasSubstr("scan: ")))) << run.err;
  EXPECT_THAT(scored_items(toy), SizeIs(JobCounts(kToyConfig, 1).of_kind("scores") +
                                        JobCounts(kMeshesOnly, 1).of_kind("scores")));
}

// A data set of one's own in which one item is wrong and a split names one that is not there.
TEST(BadDataSet, EndsWithStatus1AndTheOthersAreScored) {
  const Workspace toy;
  for (const char* item : {"ant", "bee"}) {
    toy.write(fmt::format("data set/off/{}.off", item), off_text(shapes::bumpy_sphere(1)));
    std::string values;
    for (int i = 0; i < 42; ++i) values += fmt::format("{}\n", i);
    toy.write(fmt::format("data set/maps/{}.txt", item), values);
  }
  const fs::path own = toy.write("own.py", R"(from salbench.datasets import Item, Listing, mesh, top, values
from salbench.datasets.splits import from_names

def items(root):
    found = [Item(name, [f"{root}/off/{name}.off", f"{root}/maps/{name}.txt"]) for name in ("ant", "bee")]
    return from_names(Listing(found), {"test": ["ant", "bee", "eel"]}, __file__)

def read(item):
    shape = mesh(item.files[0])
    shape.truth = values(item.files[1], len(shape.points))
    shape.picks = [top(shape.truth, 20)]
    return shape
)");
  const auto run = [&](const std::string& split) {
    toy.configure(fmt::format("dataset: {{layout: '{}', scans: false, split: {}}}\nmodels: {{RS: }}\n",
                              own.string(), split));
    return toy.salbench("run");
  };
  const std::string unknown =
      own.string() + ": the split 'test' names 'eel', which is no item of the data set: ";
  Outcome outcome = run("test");
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_THAT(lines_with(outcome.err, "'eel'"), SizeIs(1)) << outcome.err;
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("error: data set: " + unknown),
                                 HasSubstr("\n1 failed, each named above: 1 data set\n")));
  EXPECT_THAT(scored_items(toy), ElementsAre("ant", "bee"));
  EXPECT_THAT(read_file(toy.out() / "run.yaml"), HasSubstr("stage: data set, cause: \"" + unknown));
  outcome = run("''");
  EXPECT_EQ(outcome.status, 0) << "a warning where no split is asked for";
  EXPECT_THAT(outcome.err, HasSubstr("warning: " + unknown));
  toy.write("data set/maps/bee.txt", "1\n2\n");
  outcome = run("test");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("\n2 failed, each named above: 1 data set, 1 import\n"));
  EXPECT_THAT(outcome.err, HasSubstr("bee.txt: the file has 2 values, but 42 are expected"));
  EXPECT_THAT(scored_items(toy), ElementsAre("ant"));
}

}  // namespace
}  // namespace salbench
