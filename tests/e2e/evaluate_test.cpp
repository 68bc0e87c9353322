// SPDX-License-Identifier: GPL-3.0-or-later
// Saliency maps from outside are scored as if the program had computed them.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file.h"
#include "io/hdf5/hdf5_file.h"
#include "io/shapes/values_file.h"
#include "io/table.h"
#include "stages/metrics/metrics.h"
#include "tests/e2e/workspace.h"
#include "tests/support/job_counts.h"
#include "tests/support/text_column.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr std::size_t kVertices = 162;  // of either mesh

// The workspace's maps of PS, written by the program itself: what comes of them is known.
fs::path write_maps(const Workspace& toy, const std::vector<std::string>& further = {}) {
  std::vector<std::string> options = {"--format", "maps", "--models", "PS", "--to", (toy / "maps").string()};
  options.insert(options.end(), further.begin(), further.end());
  EXPECT_EQ(toy.salbench("export", options).status, 0);
  return toy / "maps/PS";
}

Outcome evaluate(const Workspace& toy, const fs::path& maps, std::vector<std::string> further = {}) {
  further.insert(further.begin(), {"--maps", maps.string(), "--name", "OWN"});
  return toy.salbench("run", further);
}

std::vector<std::vector<double>> scores_of(const Workspace& toy, const std::string& model,
                                           const std::vector<std::string>& metrics) {
  const Table table = read_csv(toy.out() / "results.csv");
  const std::vector<std::string> models = text_column(table, "model");
  std::vector<std::vector<double>> scores;
  for (const std::string& metric : metrics) {
    const std::vector<double> column = number_column(table, metric);
    std::vector<double>& of_model = scores.emplace_back();
    for (std::size_t row = 0; row < column.size(); ++row)
      if (models[row] == model) of_model.push_back(column[row]);
  }
  return scores;
}

void replace_first_line(const fs::path& file, const std::string& by) {
  const std::string text = read_file(file);
  write_file(file, by + text.substr(text.find('\n')));
}

// The rows of one model in a table without the model's name.
std::vector<std::string> rows_of(const std::string& csv, const std::string& model) {
  std::vector<std::string> rows = lines_with(csv, "," + model + ",");
  for (std::string& row : rows) row.replace(row.find("," + model + ","), model.size() + 2, ",");
  return rows;
}

TEST(Evaluate, MapsThatTheProgramWroteScoreAsTheyDidInside) {
  const Workspace toy;
  const fs::path maps = write_maps(toy);
  const Outcome run = evaluate(toy, maps);
  ASSERT_EQ(run.status, 0) << run.err;
  const auto own = rows_of(toy.results(), "OWN");
  ASSERT_THAT(own, SizeIs(JobCounts().of("scores.PS")));
  EXPECT_EQ(own, rows_of(toy.results(), "PS"));
  EXPECT_THAT(run.out, HasSubstr("OWN"));
  // Every table that compares models has it.
  for (const char* table : {"summary.csv", "per_class.csv", "significance.csv", "mean_histograms_meshes.csv"})
    EXPECT_THAT(read_file(toy.out() / table), HasSubstr("OWN")) << table;
  const Table histograms = read_csv(toy.out() / "mean_histograms_scans.csv");
  EXPECT_EQ(number_column(histograms, "OWN"), number_column(histograms, "PS"));
  EXPECT_THAT(read_file(toy.out() / "run.yaml"), HasSubstr("evaluated: {model: OWN, maps: "));
}

// With the maps and items that it had; a further model's maps come in addition.
TEST(Evaluate, ARecordIsRunAgainWithFurtherMaps) {
  const Workspace toy;
  const fs::path maps = write_maps(toy);
  ASSERT_EQ(evaluate(toy, maps, {"--items", "1"}).status, 0);
  const std::string record = (toy.out() / "run.yaml").string(), second = (toy / "second").string();
  const auto run_again = [&](const std::string& from, const std::string& name) {
    return run_process(
        {SALBENCH_PROGRAM, "run", from, "--maps", maps.string(), "--name", name, "--out", second});
  };
  const Outcome two = run_again(record, "TWO");
  ASSERT_EQ(two.status, 0) << two.err;
  const std::string results = read_file(toy / "second/results.csv");
  EXPECT_EQ(rows_of(results, "TWO"), rows_of(results, "OWN"));
  EXPECT_EQ(rows_of(results, "TWO"), rows_of(toy.results(), "OWN")) << "the same items";
  const Outcome three = run_again(second + "/run.yaml", "THREE");
  ASSERT_EQ(three.status, 0) << three.err;
  EXPECT_THAT(
      lines_with(read_file(toy / "second/run.yaml"), "evaluated: "),
      ElementsAre(AllOf(HasSubstr("model: OWN"), HasSubstr("model: TWO"), HasSubstr("model: THREE"))));
  fs::rename(maps, toy / "elsewhere");
  const Outcome gone = run_process({SALBENCH_PROGRAM, "run", record});
  EXPECT_EQ(gone.status, 2);
  EXPECT_THAT(gone.err, AllOf(HasSubstr("run.yaml:"), HasSubstr("put the maps back")));
}

TEST(Evaluate, MatchedMapsAreNotMatchedAgain) {
  const Workspace toy;
  const fs::path maps = write_maps(toy, {"--stage", "matched"});
  ASSERT_EQ(evaluate(toy, maps, {"--matched"}).status, 0);
  EXPECT_EQ(rows_of(toy.results(), "OWN"), rows_of(toy.results(), "PS"));
  EXPECT_THAT(toy.artefacts("map.OWN"), IsEmpty());
  EXPECT_THAT(toy.artefacts("matched.OWN"), SizeIs(JobCounts().of("matched.PS")));
  replace_first_line(maps / "1.val", "-0.5");
  const Outcome outside = evaluate(toy, maps, {"--matched"});
  EXPECT_EQ(outside.status, 1);
  EXPECT_THAT(lines_with(outside.err, "error: 1: matched.OWN: "), SizeIs(1)) << outside.err;
  EXPECT_THAT(outside.err, AllOf(HasSubstr("-0.5"), HasSubstr("leave out --matched")));
}

TEST(Evaluate, AnHdf5FileSaysTheSameAsAFolder) {
  const Workspace toy;
  const fs::path maps = write_maps(toy);
  ASSERT_EQ(evaluate(toy, maps).status, 0);
  const auto from_folder = rows_of(toy.results(), "OWN");

  Arrays arrays;
  for (const auto& file : fs::directory_iterator(maps)) {
    const auto lines = lines_with(read_file(file.path()), "");
    std::vector<double> values;
    for (const std::string& line : lines) values.push_back(std::stod(line));
    arrays.push_back({file.path().stem().string(), {values.size()}, values, "1", ""});
  }
  const Bytes image = hdf5_image({arrays, {}});
  const fs::path file = toy.write("own maps.h5", {reinterpret_cast<const char*>(image.data()), image.size()});
  ASSERT_EQ(evaluate(toy, file).status, 0);
  EXPECT_EQ(rows_of(toy.results(), "OWN"), from_folder);
  EXPECT_EQ(toy.computed(), JobCounts().of("map.PS")) << "maps read again, found equal, and no further";
}

TEST(Evaluate, OnlyWhatAChangedMapConcernsIsComputed) {
  const Workspace toy;
  ASSERT_EQ(toy.salbench("run").status, 0);
  const std::string alone = toy.results();
  const fs::path maps = write_maps(toy);
  ASSERT_EQ(evaluate(toy, maps).status, 0);
  EXPECT_EQ(toy.computed(), JobCounts().of_model("PS"));
  ASSERT_EQ(evaluate(toy, maps).status, 0);
  EXPECT_EQ(toy.computed(), 0);
  replace_first_line(maps / "1.val", "0.125");
  ASSERT_EQ(evaluate(toy, maps).status, 0);
  EXPECT_EQ(toy.computed(), JobCounts(kMeshesOnly, 1).of_model("PS"))
      << "of one mesh, the mean and the table";
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_EQ(toy.computed(), 0);
  EXPECT_EQ(toy.results(), alone);
}

std::string values(std::size_t n, const std::string& first = "0") {
  std::string lines = first + "\n";
  for (std::size_t i = 1; i < n; ++i) lines += std::to_string(i % 17) + "\n";
  return lines;
}

TEST(Evaluate, WhatIsWrongWithOneMapIsSaidInOneLineAndTheOthersAreScored) {
  const Workspace toy(kMeshesOnly);
  toy.write("own/1.val", values(kVertices));
  struct Bad {
    std::string text;
    std::vector<std::string> said;
  };
  for (const Bad& bad :
       {Bad{values(kVertices - 1), {"2.val", "161", "162"}}, Bad{values(kVertices, "nan"), {"2.val:1"}},
        Bad{values(kVertices, "0 1"), {"2.val:1", "expected one value"}},
        Bad{"", {"2.val", "the file has no values"}}}) {
    toy.write("own/2.val", bad.text);
    const Outcome run = evaluate(toy, toy / "own");
    EXPECT_EQ(run.status, 1);
    const auto lines = lines_with(run.err, "error: 2: map.OWN: ");
    ASSERT_THAT(lines, SizeIs(1)) << run.err;
    for (const std::string& part : bad.said) EXPECT_THAT(lines[0], HasSubstr(part));
    EXPECT_THAT(rows_of(toy.results(), "OWN"), SizeIs(1));
    EXPECT_THAT(rows_of(toy.results(), "PS"), SizeIs(2));
  }
  fs::remove(toy / "own/2.val");
  const Outcome missing = evaluate(toy, toy / "own");
  EXPECT_EQ(missing.status, 1);
  EXPECT_THAT(lines_with(missing.err, "error: 2: map.OWN: "), SizeIs(1));
  EXPECT_THAT(missing.err, HasSubstr((toy / "own/2.val").string()));
  toy.write("own/2.val", values(kVertices));
  EXPECT_EQ(evaluate(toy, toy / "own").status, 0);
}

TEST(Evaluate, OfAKindThatHasNoMapNoneIsExpected) {
  const Workspace toy;
  for (const char* name : {"1", "2"}) toy.write("own/" + std::string(name) + ".val", values(kVertices));
  const Outcome run = evaluate(toy, toy / "own");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(rows_of(toy.results(), "OWN"), SizeIs(2));
  EXPECT_THAT(rows_of(toy.results(), "PS"), SizeIs(JobCounts().of("scores.PS")));
}

TEST(Evaluate, AMapPerPolygonIsThatOfItsTriangles) {
  const Workspace toy;
  toy.write("data set/off/cube.off",
            "OFF\n8 6 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n4 0 3 2 1\n4 4 5 6 7\n"
            "4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n");
  toy.write("data set/maps/cube.csv", "5\n1\n2\n3\n4\n6\n");
  toy.configure(
      fmt::format("dataset: {{scans: false, score_on: faces, layout: '{}'}}\nmetrics: {{names: [cc], "
                  "matching: none}}\nmodels: {{RS: }}\n",
                  toy.write("own.py", R"(from salbench.datasets import Item, face_values, mesh

def items(root):
    return [Item("cube", [f"{root}/off/cube.off", f"{root}/maps/cube.csv"])]

def read(item):
    shape = mesh(item.files[0])
    shape.truth, shape.face_truth = shape.points[:, 0], face_values(item.files[1], shape)
    return shape
)")
                      .string()));
  toy.write("polygons/cube.VAL", "5\n1\n2\n3\n4\n6\n");
  toy.write("triangles/cube.val", "5\n5\n1\n1\n2\n2\n3\n3\n4\n4\n6\n6\n");
  toy.write("others/cube.val", "5\n1\n2\n3\n4\n");
  for (const char* maps : {"polygons", "triangles"}) {
    const Outcome run = evaluate(toy, toy / maps);
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_THAT(scores_of(toy, "OWN", {"cc"})[0], testing::ElementsAre(testing::DoubleNear(1, 1e-12)))
        << maps;
  }
  const Outcome others = evaluate(toy, toy / "others");
  EXPECT_EQ(others.status, 1);
  EXPECT_THAT(others.err, HasSubstr("5 values, but the shape has 8 points and 12 faces"));
}

TEST(Evaluate, MapsThatDifferByCaseAloneAreNamed) {
  const Workspace toy(kMeshesOnly);
  toy.write("own/1.val", values(kVertices));
  toy.write("own/1.VAL", values(kVertices));
  const Outcome run = toy.salbench("run", {"--maps", (toy / "own").string(), "--name", "OWN"});
  EXPECT_EQ(run.status, 2);
  EXPECT_THAT(run.err, HasSubstr("1.val differ by case alone: keep one of them"));
}

TEST(Evaluate, NamesAndFoldersThatWillNotDo) {
  const Workspace toy(kMeshesOnly);
  toy.write("own/1.val", values(kVertices));
  toy.write("empty/readme.txt", "");
  toy.write("no.h5", "not HDF5");
  const auto complaint = [&](const std::string& maps, const std::string& name) {
    const Outcome run = toy.salbench("run", {"--maps", (toy / maps).string(), "--name", name});
    EXPECT_EQ(run.status, 2) << run.err;
    EXPECT_THAT(lines_with(run.err, ""), SizeIs(1)) << run.err;
    EXPECT_FALSE(fs::exists(toy.cache()) || fs::exists(toy.out()));
    return run.err;
  };
  for (const char* taken :
       {"PS", "HS", "LS", "GS", "Avg", "constant", "hs", "Rs", "ls", "gs", "AVG", "CONSTANT", "lVj"})
    EXPECT_THAT(complaint("own", taken), AllOf(HasSubstr("--name"), HasSubstr(taken)));
  for (const char* bad : {"", "a b", "../x", "ä"}) EXPECT_THAT(complaint("own", bad), HasSubstr("letters"));
  EXPECT_THAT(complaint("empty", "OWN"), AllOf(HasSubstr("--maps"), HasSubstr("1.val")));
  EXPECT_THAT(complaint("nowhere", "OWN"), AllOf(HasSubstr("nowhere"), HasSubstr("cannot be read")));
  EXPECT_THAT(complaint("no.h5", "OWN"), AllOf(HasSubstr("no.h5"), HasSubstr("HDF5")));
}

// Scores of matched maps are those of before metrics could read others: a matched map, given as it stands,
// has the same scores as the map that it was made of.
TEST(Evaluate, MatchingByNameIsThatOfTheMapsThemselves) {
  const std::vector<std::string> names = {"ig", "kl", "kl_smoothed", "sim", "sim_minmax"};
  const auto with = [&](const std::string& matching) {
    return fmt::format(
        "dataset: {{scans: false}}\nmodels: {{PS: }}\nmetrics: {{names: [{}], matching: {}}}\n",
        fmt::join(names, ", "), matching);
  };
  const Workspace toy(with("histogram"));
  const fs::path matched = write_maps(toy, {"--stage", "matched"});
  ASSERT_EQ(evaluate(toy, matched, {"--matched"}).status, 0);
  const auto of_matched = scores_of(toy, "OWN", names);
  EXPECT_EQ(scores_of(toy, "PS", names), of_matched);
  toy.configure(with("none"));
  ASSERT_EQ(evaluate(toy, write_maps(toy)).status, 0);
  const auto of_map = scores_of(toy, "PS", names);
  EXPECT_EQ(scores_of(toy, "OWN", names), of_map);
  for (std::size_t i = 0; i < of_map.size(); ++i) EXPECT_NE(of_map[i], of_matched[i]) << names[i];
}

// A constant map that is given is level with the one that remarks speak of, by every metric.
TEST(Evaluate, AConstantMapIsLevelWithTheConstantMapOfTheRemarks) {
  const Workspace toy("dataset: {scans: false}\nmodels: {PS: }\nmetrics: all\n");
  std::string flat;
  for (std::size_t i = 0; i < kVertices; ++i) flat += "7\n";
  for (const char* name : {"flat/1.val", "flat/2.val"}) {
    fs::create_directories(toy / "flat");
    toy.write(name, flat);
  }
  ASSERT_EQ(toy.salbench("run", {"--maps", (toy / "flat").string(), "--name", "FLAT"}).status, 0);
  const std::string remarks = read_file(toy.out() / "chance.csv");
  for (const Metric& metric : metric_table())
    EXPECT_THAT(lines_with(remarks, fmt::format("meshes,{},", metric.name)),
                testing::ElementsAre(HasSubstr("FLAT (level)")))
        << metric.name;
}

}  // namespace
}  // namespace salbench
