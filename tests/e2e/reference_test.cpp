// SPDX-License-Identifier: GPL-3.0-or-later
// --reference: a density, or what stands for one.
#include <functional>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file.h"
#include "io/table.h"
#include "tests/e2e/workspace.h"

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
}

// Tables of simulated participants begin with a line that says so, and are tables all the same.
TEST_F(Reference, ATableOfASimulatedRunCanBeRead) {
  toy_.configure("dataset: {scans: false, participants: simulated}\nmodels: {PS: }\n");
  ASSERT_EQ(toy_.salbench("run").status, 0);
  const fs::path table = toy_ / "simulated.csv";
  fs::copy(toy_.out() / "mean_histograms_meshes.csv", table);
  EXPECT_THAT(read_file(table), testing::StartsWith("# SIMULATED"));
  EXPECT_THAT(number_column(read_csv(table), "GS"), SizeIs(100));
  const std::string results = toy_.results();
  const Outcome again = run(table);
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_THAT(lines_with(again.err, "simulated.csv"), SizeIs(1));
  EXPECT_THAT(again.err, HasSubstr("simulated.csv: SIMULATED participants"));
}

}  // namespace
}  // namespace salbench
