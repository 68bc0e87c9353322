// SPDX-License-Identifier: GPL-3.0-or-later
// Outputs may change only with a version: this is what keeps a cache honest from one commit to the next.
#include <algorithm>
#include <cstdlib>
#include <map>
#include <mutex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/shapes/text_scanner.h"
#include "tests/pipeline/golden_table.h"
#include "tests/support/cloud_text.h"
#include "tests/support/memory_store.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/toy_data.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

// --- the rules -----------------------------------------------------------------------------------------

GoldenRow sample_row(const std::string& stage, double mean = 2, std::int32_t version = 1) {
  return {"published", stage, version, "mesh", "saliency", "0a", {10, 10, mean, 1, 2.5}};
}

const std::vector<std::pair<std::string, std::string>> kInputs = {{"published/fpfh", "published/normals"},
                                                                  {"published/map", "published/fpfh"}};
const std::vector<GoldenRow> kGolden = {sample_row("normals"), sample_row("fpfh"), sample_row("map")};

TEST(GoldenRules, TheSameOutputIsNoChangeNorIsItsRounding) {
  EXPECT_THAT(golden_changes(kGolden, kGolden, kInputs), IsEmpty());
  std::vector<GoldenRow> now = kGolden;
  now[1].fingerprint.mean += 1e-7;
  EXPECT_THAT(golden_changes(now, kGolden, kInputs), IsEmpty());
}

TEST(GoldenRules, AnotherOutputUnderTheSameVersionIsForbidden) {
  const std::vector<GoldenRow> now = {sample_row("normals"), sample_row("fpfh", 2.00001),
                                      sample_row("map", 3)};
  const auto changes = golden_changes(now, kGolden, kInputs);
  ASSERT_THAT(changes, SizeIs(2));
  for (const GoldenChange& change : changes) {
    EXPECT_TRUE(change.forbidden);
    EXPECT_THAT(change.what, HasSubstr("raise the stage's version"));
  }
  EXPECT_THAT(changes[0].what, HasSubstr("published/fpfh/mesh"));
}

TEST(GoldenRules, ARaisedVersionOrOtherOptionsExcuseTheStageAndWhatReadsIt) {
  std::vector<GoldenRow> now = {sample_row("normals", 2, 2), sample_row("fpfh", 3), sample_row("map", 3)};
  auto changes = golden_changes(now, kGolden, kInputs);
  ASSERT_THAT(changes, SizeIs(3));
  for (const GoldenChange& change : changes) EXPECT_FALSE(change.forbidden) << change.what;

  now = {sample_row("normals", 3), sample_row("fpfh", 3), sample_row("map", 3)};
  now[1].options = "0b";
  changes = golden_changes(now, kGolden, kInputs);
  ASSERT_THAT(changes, SizeIs(3));
  EXPECT_TRUE(changes[0].forbidden);  // nothing excuses what comes before
  EXPECT_FALSE(changes[1].forbidden);
  EXPECT_FALSE(changes[2].forbidden);
}

TEST(GoldenRules, NewAndVanishedOutputsAreChanges) {
  const std::vector<GoldenRow> now = {sample_row("normals"), sample_row("fpfh"), sample_row("other")};
  const auto changes = golden_changes(now, kGolden, kInputs);
  ASSERT_THAT(changes, SizeIs(2));
  EXPECT_EQ(changes[0].what, "published/other/mesh/saliency is new");
  EXPECT_EQ(changes[1].what, "published/map/mesh/saliency is no longer computed");
}

TEST(GoldenRules, AnUpdateLeavesWhatAgreesToTheDigit) {
  const std::vector<GoldenRow> now = {sample_row("normals", 2 + 1e-9, 2), sample_row("fpfh", 3, 2),
                                      sample_row("new")};
  const std::vector<GoldenRow> rows = updated(now, kGolden);
  ASSERT_THAT(rows, SizeIs(3));
  EXPECT_EQ(rows[0].version, 2);
  EXPECT_EQ(rows[0].fingerprint.mean, 2);
  EXPECT_EQ(rows[1].fingerprint.mean, 3);
  EXPECT_EQ(rows[2].stage, "new");
}

TEST(GoldenRules, AFingerprintSeesEachValueAndTheOrder) {
  const auto print = [](const std::vector<double>& values) {
    FingerprintMaker maker;
    maker.add(values);
    return maker.result();
  };
  const Fingerprint base = print({1, 2, 3, 4});
  EXPECT_EQ(base.count, 4);
  EXPECT_DOUBLE_EQ(base.mean, 2.5);
  EXPECT_DOUBLE_EQ(base.sd, std::sqrt(1.25));
  EXPECT_TRUE(agree(print({1, 2, 3, 4 + 1e-9}), base));
  EXPECT_FALSE(agree(print({1, 2, 3, 4.0001}), base));
  EXPECT_FALSE(agree(print({1, 3, 2, 4}), base));
  EXPECT_FALSE(agree(print({1, 2, 3}), base));
  EXPECT_FALSE(agree(print({1, 2, 3, 4, std::nan("")}), base));
}

TEST(GoldenRules, TheTableReadsBackAsItWasWritten) {
  const auto back = golden_rows(parse_csv(to_csv(golden_table(kGolden)), "stages.csv"));
  ASSERT_THAT(back, SizeIs(3));
  EXPECT_THAT(golden_changes(back, kGolden, kInputs), IsEmpty());
  EXPECT_EQ(to_csv(golden_table(back)), to_csv(golden_table(kGolden)));
}

// --- the outputs ---------------------------------------------------------------------------------------

// Keeps what passes on its way into a store.
class RecordingStore final : public Store {
 public:
  struct Record {
    Recipe recipe;
    std::string item;
    Arrays arrays;
  };

  std::optional<Digest> find(const Digest& key) const override { return store_.find(key); }
  std::vector<std::string> stages() const override { return store_.stages(); }
  bool has_item(std::string_view stage, std::string_view item) const override {
    return store_.has_item(stage, item);
  }
  std::optional<Arrays> load(const Digest& key) override { return store_.load(key); }
  std::string remark(std::string_view stage, const Digest& key) override { return store_.remark(stage, key); }
  void save(std::string_view family, Artefact artefact) override {
    {
      const std::lock_guard lock(mutex_);
      records_.push_back({artefact.recipe, artefact.note.item, arrays_of(artefact)});
    }
    store_.save(family, std::move(artefact));
  }

  // By stage and item, so in no order of threads.
  std::vector<Record> records() const {
    std::vector<Record> sorted = records_;
    std::sort(sorted.begin(), sorted.end(), [](const Record& a, const Record& b) {
      return a.recipe.stage != b.recipe.stage ? a.recipe.stage < b.recipe.stage
                                              : natural_less(a.item, b.item);
    });
    return sorted;
  }

 private:
  MemoryStore store_;
  std::mutex mutex_;
  std::vector<Record> records_;
};

constexpr const char* kCloud = "cloud";  // name of the point cloud among the toy data

struct Outputs {
  std::vector<GoldenRow> rows;
  std::vector<std::pair<std::string, std::string>> inputs;
};

std::string options_digest(const Recipe& recipe) {
  Hasher hasher;
  hasher.add(recipe.options);
  hasher.add(recipe.seed);
  return hasher.digest().hex().substr(0, 8);
}

// The arrays of all items of one kind are one sequence of values to the fingerprint.
void collect(const std::string& protocol, const std::vector<RecordingStore::Record>& records,
             Outputs& outputs) {
  std::map<std::string, std::pair<GoldenRow, FingerprintMaker>> by_subject;
  for (const auto& [recipe, item, arrays] : records) {
    const bool is_scan = item == "scans" || item.find('_') != item.npos;
    const bool is_cloud = item == "clouds" || item == kCloud;
    for (const Array& array : arrays) {
      GoldenRow row{protocol,
                    recipe.stage,
                    recipe.stage_version,
                    std::string(levels()[is_scan    ? kScans
                                         : is_cloud ? kClouds
                                                    : kMeshes]
                                    .unit),
                    array.name,
                    options_digest(recipe),
                    {}};
      const std::string subject = row.subject();
      by_subject.try_emplace(subject, std::move(row), FingerprintMaker())
          .first->second.second.add(array.values);
    }
  }
  for (auto& [subject, entry] : by_subject) {
    entry.first.fingerprint = entry.second.result();
    outputs.rows.push_back(std::move(entry.first));
  }
}

// What each rule reads.
void collect_inputs(const std::string& protocol, const ToyRun& toy, Outputs& outputs) {
  const std::string prefix = protocol + "/";
  for (const Rule& rule : toy.project.rules)
    for (const std::size_t input : rule.inputs)
      outputs.inputs.emplace_back(prefix + rule.stage, prefix + toy.project.rules[input].stage);
}

void expect_every_rule(const std::string& protocol, const Rules& rules, const Outputs& outputs) {
  for (const Rule& rule : rules) {
    const std::string_view shape = levels()[rule.over].unit;
    EXPECT_TRUE(std::any_of(outputs.rows.begin(), outputs.rows.end(),
                            [&](const GoldenRow& golden) {
                              return golden.protocol == protocol && golden.stage == rule.stage &&
                                     golden.shape == shape;
                            }))
        << rule.stage << " did not run on a " << shape << ": the toy data must reach every rule";
  }
}

std::string every_model() {
  std::string yaml = "models:\n";
  for (const ModelRow& row : model_rows()) yaml += "  " + std::string(row.name) + ":\n";
  return yaml;
}

// Large enough for what works on part of a shape only: the simplification of MS begins at 3000 faces.
Outputs toy_outputs() {
  const TemporaryFolder data;
  write_toy_item(data.path(), "1", shapes::bumpy_sphere(4, 0.3));
  write_toy_item(data.path(), "2", shapes::bumpy_sphere(3));
  const Mesh points = shapes::bumpy_sphere(3, 0.25);  // its normals are computed
  write_toy_truth(data.path(), kCloud, points);
  data.write(fmt::format("Meshes/{}.ply", kCloud), ply_cloud_text(points.vertices));
  Outputs outputs;
  for (const std::string protocol : {"published", "text"}) {
    RecordingStore store;
    ToyRun toy(
        data.path(), store,
        "protocol: " + protocol + "\nscan: {step_degrees: 0.5}\npicture: {size: 64}\n" + every_model());
    toy.run();
    for (const Failure& failure : toy.resolver->failures())
      ADD_FAILURE() << toy.project.name(failure.job) << ": " << toy.project.rule(failure.job).stage << ": "
                    << failure.cause;
    collect(protocol, store.records(), outputs);
    collect_inputs(protocol, toy, outputs);
    expect_every_rule(protocol, toy.project.rules, outputs);
  }
  return outputs;
}

// After a stage was added, its version was raised or its options changed; an output that changed without any
// of these is refused. To accept every output as it is, as after a change of the toy data, remove the table
// first.
constexpr auto kToUpdate =
    "SALBENCH_UPDATE_GOLDEN=1 build/release/test_pipeline --gtest_filter='Golden.*' records it";

TEST(Golden, NoOutputChangesUnderTheSameVersion) {
  const fs::path file = SALBENCH_GOLDEN_TABLE;
  const std::vector<GoldenRow> golden =
      fs::exists(file) ? golden_rows(read_csv(file)) : std::vector<GoldenRow>{};
  const Outputs outputs = toy_outputs();
  const bool update = std::getenv("SALBENCH_UPDATE_GOLDEN") != nullptr;
  for (const GoldenChange& change : golden_changes(outputs.rows, golden, outputs.inputs)) {
    if (change.forbidden)
      ADD_FAILURE() << change.what;
    else if (!update)
      ADD_FAILURE() << change.what << ": " << kToUpdate;
  }
  if (update && !HasFailure()) write_file(file, to_csv(golden_table(updated(outputs.rows, golden))));
}

}  // namespace
}  // namespace salbench
