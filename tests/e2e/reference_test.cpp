// SPDX-License-Identifier: GPL-3.0-or-later
// --reference: a density, or what stands for one.
#include <functional>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file.h"
#include "io/table.h"
#include "tests/e2e/workspace.h"
#include "tests/support/toy_data.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

class Reference : public testing::Test {
 protected:
  // A falling density, each value multiplied and then edited.
  fs::path column(double factor, const std::function<void(std::vector<std::string>&)>& edit = {}) const {
    std::vector<std::string> values;
    for (int bin = 0; bin < 100; ++bin) values.push_back(fmt::format("{}", factor * (99.5 - bin) / 50));
    if (edit) edit(values);
    return toy_.write("reference.csv", fmt::format("GS\n{}\n", fmt::join(values, "\n")));
  }
  Outcome run(const fs::path& reference) const {
    return toy_.salbench("run", {"--reference", reference.string()});
  }
  std::string complaint(const fs::path& reference) const {
    const Outcome outcome = run(reference);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_THAT(lines_with(outcome.err, "error: "), SizeIs(1)) << outcome.err;
    return outcome.err;
  }

  Workspace toy_{kMeshesOnly};
};

std::vector<double> scores(const std::string& csv) {
  return number_column(parse_csv(csv, "results.csv"), "nss");
}

TEST_F(Reference, ProbabilitiesStandForTheDensityOfTheirShape) {
  ASSERT_EQ(run(column(1)).status, 0);
  const std::vector<double> with_density = scores(toy_.results());
  const Outcome with_probabilities = run(column(0.01));
  ASSERT_EQ(with_probabilities.status, 0);
  EXPECT_THAT(lines_with(with_probabilities.err, "reference.csv"), SizeIs(1));
  EXPECT_THAT(with_probabilities.err,
              AllOf(HasSubstr("reference.csv"), HasSubstr("sums to 1"), HasSubstr("scaled")));
  const std::vector<double> scaled = scores(toy_.results());
  ASSERT_EQ(scaled.size(), with_density.size());
  for (std::size_t i = 0; i < scaled.size(); ++i) EXPECT_NEAR(scaled[i], with_density[i], 1e-12);
}

TEST_F(Reference, ADensityIsTakenAsItIs) {
  const Outcome exact = run(column(1));
  EXPECT_THAT(lines_with(exact.err, "reference.csv"), IsEmpty());
  EXPECT_THAT(lines_with(run(column(1.0001)).err, "reference.csv"), IsEmpty()) << "written with few digits";
}

TEST_F(Reference, AnythingElseIsRefusedWithFileAndLine) {
  const auto with = [&](std::size_t bin, const std::string& value) {
    return complaint(column(1, [&](auto& values) { values[bin] = value; }));
  };
  EXPECT_THAT(with(6, "-0.5"), AllOf(HasSubstr("reference.csv:8: "), HasSubstr("-0.5")));
  EXPECT_THAT(with(7, "inf"), HasSubstr("reference.csv:9: "));
  EXPECT_THAT(with(8, "nan"), HasSubstr("reference.csv:10: "));
  EXPECT_THAT(with(9, "many"), HasSubstr("reference.csv:11: "));
  EXPECT_THAT(complaint(column(0)), AllOf(HasSubstr("reference.csv:2: "), HasSubstr("sums to 0")));
  EXPECT_THAT(complaint(column(1e307)), HasSubstr("reference.csv:2: ")) << "the sum overflows";
  EXPECT_THAT(complaint(column(1, [](auto& values) { values.pop_back(); })), HasSubstr("99 rows"));
  EXPECT_THAT(complaint(toy_.write("reference.csv", "bin,LS\n0,1\n")),
              AllOf(HasSubstr("reference.csv"), HasSubstr("GS")));
  EXPECT_THAT(complaint("/no/such.csv"), HasSubstr("/no/such.csv"));
}

// Tables of simulated participants have a column that says so, and are tables all the same.
TEST_F(Reference, ATableOfASimulatedRunCanBeRead) {
  toy_.configure("dataset: {scans: false, participants: simulated}\nmodels: {PS: }\n");
  ASSERT_EQ(toy_.salbench("run").status, 0);
  const fs::path table = toy_ / "simulated.csv";
  fs::copy(toy_.out() / "mean_histograms_meshes.csv", table);
  EXPECT_THAT(read_file(table), testing::StartsWith("bin_left,GS,PS,remarks\n"));
  EXPECT_THAT(number_column(read_csv(table), "GS"), SizeIs(100));
  const Outcome again = run(table);
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_THAT(lines_with(again.err, "simulated.csv"), SizeIs(1));
  EXPECT_THAT(again.err, HasSubstr("simulated.csv: SIMULATED participants"));
}

// Commas in a remark had made it the header, and the last of several had been the only one.
TEST_F(Reference, ATableOfAPartialRunWithSimulatedPeopleWarnsOfBoth) {
  const std::vector<std::string> remarks = {"PARTIAL: 1 of 2, so far", "SIMULATED: by chance, not people"};
  const auto as_now = [&](const std::string& text) {
    Table table = parse_csv(text, "");
    table.remarks = remarks;
    return to_csv(table);
  };
  const auto as_1_0 = [&](const std::string& text) {
    return fmt::format("# {}\n# {}\n{}", remarks[0], remarks[1], text);
  };
  const auto warns_of_both = [](const Outcome& outcome) {
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(lines_with(outcome.err, ".csv: PARTIAL: 1 of 2, so far"), SizeIs(1)) << outcome.err;
    EXPECT_THAT(lines_with(outcome.err, ".csv: SIMULATED: by chance, not people"), SizeIs(1)) << outcome.err;
  };
  const auto warns_of_both_in = [&](const auto& with_remarks) {
    warns_of_both(run(toy_.write("reference.csv", with_remarks(read_file(column(1))))));
    const std::string scores = toy_.write("scores.csv", with_remarks(toy_.results())).string();
    warns_of_both(
        run_process({SALBENCH_PROGRAM, "conclude", scores, "--out", (toy_ / "concluded").string()}));
  };
  warns_of_both_in(as_now);
  warns_of_both_in(as_1_0);
}

// --- of a part of the data set -----------------------------------------------------------------------------

std::vector<std::string> rows_of_item(const Workspace& toy, const std::string& item) {
  auto rows = lines_with(toy.results(), fmt::format("meshes,{},", item));
  const auto scans = lines_with(toy.results(), fmt::format("scans,{},", item));
  rows.insert(rows.end(), scans.begin(), scans.end());
  return rows;
}

std::vector<double> reference_of(const Workspace& toy, const char* shapes) {
  return number_column(read_csv(toy.out() / fmt::format("mean_histograms_{}.csv", shapes)), "GS");
}

// Meshes and scans of "2", matched to the mean over both meshes as in a run over both.
TEST(ReferenceOfItems, APartIsMatchedToTheMeanOverAll) {
  const Workspace toy;
  const Outcome part = toy.salbench("run", {"--items", "2"});
  ASSERT_EQ(part.status, 0) << part.err;
  EXPECT_THAT(lines_with(part.err, "jobs of items that are left out come first"), SizeIs(1)) << part.err;
  EXPECT_THAT(read_file(toy.out() / "run.yaml"), HasSubstr("mean over all items of the data set or split"));
  const std::string results = toy.results();
  const auto rows = rows_of_item(toy, "2");
  const auto on_meshes = reference_of(toy, "meshes"), on_scans = reference_of(toy, "scans");
  EXPECT_THAT(rows_of_item(toy, "1"), IsEmpty());
  EXPECT_THAT(toy.artefacts("map.PS"), SizeIs(13)) << "of the other mesh its ground truth alone";

  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_EQ(rows_of_item(toy, "2"), rows);
  EXPECT_EQ(reference_of(toy, "meshes"), on_meshes);
  EXPECT_EQ(reference_of(toy, "scans"), on_scans);
  const Outcome again = toy.salbench("run", {"--items", "2"});
  EXPECT_THAT(lines_with(again.err, "come first"), IsEmpty()) << again.err;
  EXPECT_EQ(toy.results(), results);
  EXPECT_THAT(lines_with(toy.salbench("plan", {"--items", "2"}).out, "0 jobs to do"), SizeIs(1));
}

TEST(ReferenceOfItems, ThatOfTheItemsAloneIsAskedForByName) {
  const Workspace toy;
  ASSERT_EQ(toy.salbench("run").status, 0);
  const auto of_all = reference_of(toy, "meshes");
  const auto rows = rows_of_item(toy, "2");
  ASSERT_EQ(toy.salbench("run", {"--items", "2", "--reference", "items"}).status, 0);
  EXPECT_THAT(read_file(toy.out() / "run.yaml"), HasSubstr("mean over the items of the run"));
  EXPECT_NE(reference_of(toy, "meshes"), of_all);
  EXPECT_NE(rows_of_item(toy, "2"), rows);
  // Over all items it is what there is without it.
  ASSERT_EQ(toy.salbench("run", {"--reference", "items"}).status, 0);
  EXPECT_EQ(toy.computed(), 0);
  EXPECT_EQ(reference_of(toy, "meshes"), of_all);
}

TEST(ReferenceOfItems, ExportHasTheMatchedMapsOfTheWholeRun) {
  const Workspace toy(kMeshesOnly);
  ASSERT_EQ(toy.salbench("run").status, 0);
  const auto matched = toy.artefacts("matched.PS");
  ASSERT_EQ(toy.salbench("export", {"--items", "2", "--to", (toy / "2.h5").string()}).status, 0);
  EXPECT_EQ(toy.artefacts("matched.PS"), matched) << "no other ones";
  ASSERT_EQ(toy.salbench("gc", {"--items", "2"}).status, 0);
  EXPECT_THAT(toy.artefacts("ground_truth"), SizeIs(2)) << "the mean is made of both";
  EXPECT_THAT(toy.artefacts("matched.PS"), SizeIs(1));
}

TEST(ReferenceOfItems, AnotherItemThatFailsIsAWarning) {
  const Workspace toy(kMeshesOnly);
  toy.write("data set/Meshes/1.off", "OFF\n1 0 0\n0 0 0\n");
  const Outcome part = toy.salbench("run", {"--items", "2"});
  EXPECT_EQ(part.status, 0) << part.err;
  EXPECT_THAT(lines_with(part.err, "warning: 1: mesh: "), SizeIs(1)) << part.err;
  EXPECT_EQ(toy.salbench("run").status, 1);
  EXPECT_THAT(lines_with(toy.results(), "meshes,2,"), SizeIs(2));
}

// --- items with ground truth -------------------------------------------------------------------------------

void add_mesh_without_truth(const Workspace& toy) {
  toy.write("data set/Meshes/3.off", off_text(shapes::bumpy_sphere(2, 0.15)));
}

TEST(ScoredItems, AreThoseWithGroundTruth) {
  const Workspace toy(kMeshesOnly);
  add_mesh_without_truth(toy);
  ASSERT_EQ(toy.salbench("run", {"--items", "scored"}).status, 0);
  EXPECT_THAT(toy.artefacts("map.PS"), SizeIs(2));
  const std::string results = toy.results();
  ASSERT_EQ(toy.salbench("run").status, 0);
  EXPECT_THAT(toy.artefacts("map.PS"), SizeIs(3));
  EXPECT_EQ(toy.results(), results);
  fs::remove_all(toy.data() / "Distributions");
  fs::remove_all(toy.data() / "RawData");
  const Outcome none = toy.salbench("run", {"--items", "scored"});
  EXPECT_EQ(none.status, 2);
  EXPECT_THAT(none.err, HasSubstr("--items scored: no item has ground truth"));
}

TEST(ScoredItems, AreWhatEvaluateTakesSoThatMapsOfThemAreEnough) {
  const Workspace toy(kMeshesOnly);
  add_mesh_without_truth(toy);
  ASSERT_EQ(
      toy.salbench("export", {"--format", "maps", "--models", "PS", "--to", (toy / "maps").string()}).status,
      0);
  fs::remove(toy / "maps/PS/3.val");
  const std::vector<std::string> mine = {"--maps", (toy / "maps/PS").string(), "--name", "OWN"};
  const Outcome run = toy.salbench("run", mine);
  EXPECT_EQ(run.status, 0) << run.err;
  fs::remove(toy / "maps/PS/2.val");
  const Outcome missing = toy.salbench("run", mine);
  EXPECT_EQ(missing.status, 1);
  EXPECT_THAT(lines_with(missing.err, "2.val: missing"), SizeIs(1)) << "named once: " << missing.err;
}

TEST(ScoredItems, AreAllWhereParticipantsAreSimulated) {
  const Workspace toy("dataset: {scans: false, participants: simulated}\nmodels: {PS: , RS: }\n");
  add_mesh_without_truth(toy);
  ASSERT_EQ(toy.salbench("run", {"--items", "scored"}).status, 0);
  EXPECT_THAT(lines_with(toy.results(), "meshes,3,"), SizeIs(2));
}

}  // namespace
}  // namespace salbench
