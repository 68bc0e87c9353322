// SPDX-License-Identifier: GPL-3.0-or-later
// Real data: where chance and a constant map stand by every metric, and that remarks say so.
#include <map>
#include <set>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/file.h"
#include "io/table.h"
#include "stages/metrics/metrics.h"
#include "tests/e2e/workspace.h"
#include "tests/support/data.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::IsSubsetOf;

// A map that is 0.5 everywhere for each mesh with ground truth, whose file has a line per vertex; their
// names.
std::vector<std::string> write_flat_maps(const fs::path& truth, const fs::path& folder) {
  fs::create_directories(folder);
  std::vector<std::string> items;
  for (const fs::directory_entry& file : fs::directory_iterator(truth)) {
    if (file.path().extension() != ".val") continue;
    items.push_back(file.path().stem().string());
    std::string flat;
    for (const char c : read_file(file.path()))
      if (c == '\n') flat += "0.5\n";
    write_file(folder / file.path().filename(), flat);
  }
  return items;
}

std::map<std::string, double> means_by_model(const Table& results, const std::string& metric) {
  const std::vector<std::string> models = text_column(results, "model");
  const std::vector<double> values = number_column(results, metric);
  std::map<std::string, double> sums, counts;
  for (std::size_t row = 0; row < values.size(); ++row) {
    sums[models[row]] += values[row];
    counts[models[row]] += 1;
  }
  for (auto& [model, sum] : sums) sum /= counts[model];
  return sums;
}

// Models that a reference is level with or ahead of.
std::set<std::string> passed(const std::map<std::string, double>& means, const std::string& reference,
                             bool higher_is_better) {
  std::set<std::string> models;
  for (const auto& [model, mean] : means) {
    const double ahead = higher_is_better ? means.at(reference) - mean : mean - means.at(reference);
    if (model != "RS" && ahead >= -1e-12) models.insert(model);
  }
  return models;
}

// The models that a remark names behind some words, up to the next part of it.
std::set<std::string> named(const std::string& remark, const std::string& words,
                            const std::map<std::string, double>& means) {
  std::set<std::string> models;
  const std::size_t from = remark.find(words);
  if (from == std::string::npos) return models;
  const std::string part = remark.substr(from, remark.find(';', from) - from);
  for (const auto& [model, mean] : means)
    if (part.find(" " + model + " (") != std::string::npos) models.insert(model);
  return models;
}

TEST(RealData, ChanceAndAConstantMapRankBelowTheModelsUnlessARemarkSaysNot) {
  const auto data = real_data();
  if (!data) GTEST_SKIP() << kNoRealData;
  const Workspace toy("dataset: {scans: false}\nmetrics: all\n");
  const auto items = write_flat_maps(*data / "SchellingData/Distributions", toy / "flat");
  const Outcome run =
      run_process({SALBENCH_PROGRAM, "run", toy.config().string(), "--data", data->string(), "--items",
                   fmt::format("{}", fmt::join(items, ",")), "--maps", (toy / "flat").string(), "--name",
                   "FLAT", "--cache", toy.cache().string(), "--out", toy.out().string(), "--quiet"});
  ASSERT_EQ(run.status, 0) << run.err;
  const Table results = read_csv(toy.out() / "results.csv");
  const std::string remarks = read_file(toy.out() / "chance.csv");
  for (const Metric& metric : metric_table()) {
    const auto means = means_by_model(results, metric.name);
    const auto lines = lines_with(remarks, fmt::format("meshes,{},", metric.name));
    ASSERT_EQ(lines.size(), 1U) << metric.name;  // the constant map is level with FLAT at least
    const std::set<std::string> by_constant = passed(means, "FLAT", metric.higher_is_better),
                                by_chance = passed(means, "RS", metric.higher_is_better);
    EXPECT_EQ(named(lines[0], "a constant map is", means), by_constant) << metric.name;
    EXPECT_EQ(named(lines[0], "chance (RS) is", means), by_chance) << metric.name;
    if (metric.matching == Matching::none) continue;
    // Matched maps are always better than chance; KL, SIM and the information gain say otherwise of some.
    const std::set<std::string> flat = {"FLAT"};
    EXPECT_THAT(by_constant, IsSubsetOf(flat)) << metric.name;
    EXPECT_THAT(by_chance, IsSubsetOf(flat)) << metric.name;
  }
}

}  // namespace
}  // namespace salbench
