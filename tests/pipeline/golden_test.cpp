// SPDX-License-Identifier: GPL-3.0-or-later
// Outputs may change only with a version: this keeps caches valid between commits. tests/golden/stages.csv
// has a few numbers for each array that a stage writes over the toy data. What is computed from maps is
// listed for one model and for people.
#include <iterator>

#include "io/shapes/text_scanner.h"
#include "io/table.h"
#include "tests/support/cloud_text.h"
#include "tests/support/columns.h"
#include "tests/support/memory_store.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"
#include "tests/support/toy_data.h"

namespace salbench {
namespace {

// Robust to the last digits of another machine's mathematics, sensitive to any value and to the order: number
// of values and of finite ones; of the latter mean, standard deviation, and the mean with weights in [0, 1)
// that depend on the position.
using Fingerprint = std::array<double, 5>;
constexpr std::array kNumbers = {"count", "finite", "mean", "sd", "weighted_mean"};

Fingerprint fingerprint_of(const std::vector<double>& values) {
  double finite = 0, sum = 0, weighted = 0, weights = 0, squares = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) continue;
    // Fractional parts of multiples of the golden ratio: nearby positions have different weights.
    const double weight = std::fmod(static_cast<double>(i) * 0.6180339887498949, 1.0);
    ++finite;
    sum += values[i];
    weighted += weight * values[i];
    weights += weight;
  }
  const double mean = finite > 0 ? sum / finite : 0;
  for (const double value : values)
    if (std::isfinite(value)) squares += (value - mean) * (value - mean);
  return {static_cast<double>(values.size()), finite, mean, finite > 0 ? std::sqrt(squares / finite) : 0,
          weights > 0 ? weighted / weights : 0};
}

bool agree(const Fingerprint& a, const Fingerprint& b) {  // to 1e-6 of the values' size
  const double size = std::hypot(b[2], b[3]);
  return a[0] == b[0] && a[1] == b[1] && std::ranges::all_of(std::array{2U, 3U, 4U}, [&](unsigned k) {
           return std::abs(a[k] - b[k]) <= 1e-6 * size;
         });
}

// Subject of a row: protocol, stage, kind of shapes, array.
using Subject = std::array<std::string, 4>;
std::string stage_of(const Subject& subject) { return subject[0] + "/" + subject[1]; }
std::string text_of(const Subject& subject) {
  return stage_of(subject) + "/" + subject[2] + "/" + subject[3];
}

struct Golden {
  std::int64_t version = 0;
  std::string options;  // digest of the stage's options and seed
  Fingerprint fingerprint{};
};
bool repeat(const Golden& a, const Golden& b) {
  return a.version == b.version && a.options == b.options && agree(a.fingerprint, b.fingerprint);
}
using GoldenTable = std::map<Subject, Golden>;
using Reads = std::vector<std::pair<std::string, std::string>>;  // pairs of a stage and one of its inputs

Table table_of(const GoldenTable& golden) {
  Table table{{"protocol", "stage", "version", "shape", "array", "options"}, {}};
  table.columns.insert(table.columns.end(), kNumbers.begin(), kNumbers.end());
  for (const auto& [subject, row] : golden) {
    const auto& [count, finite, mean, sd, weighted] = row.fingerprint;
    table.rows.push_back({subject[0], subject[1], row.version, subject[2], subject[3], row.options,
                          static_cast<std::int64_t>(count), static_cast<std::int64_t>(finite), mean, sd,
                          weighted});
  }
  return table;
}

GoldenTable golden_of(const Table& table) {
  GoldenTable golden;
  const auto text = [&](const char* column) { return text_column(table, column); };
  const auto protocol = text("protocol"), stage = text("stage"), shape = text("shape"), array = text("array"),
             options = text("options");
  const std::vector<double> version = number_column(table, "version");
  for (std::size_t i = 0; i < table.rows.size(); ++i)
    golden[{protocol[i], stage[i], shape[i], array[i]}] = {
        static_cast<std::int64_t>(version[i]), options[i], {}};
  for (std::size_t k = 0; k < kNumbers.size(); ++k) {
    const std::vector<double> numbers = number_column(table, kNumbers[k]);
    for (std::size_t i = 0; i < numbers.size(); ++i)
      golden[{protocol[i], stage[i], shape[i], array[i]}].fingerprint[k] = numbers[i];
  }
  return golden;
}

// Lines on changed outputs: forbidden if neither version nor options nor an input changed.
struct Changes {
  std::vector<std::string> forbidden, excused;
};

Changes changes(const GoldenTable& now, const GoldenTable& golden, const Reads& inputs) {
  std::set<std::string> excused;
  for (const auto& [subject, row] : now) {
    const auto before = golden.find(subject);
    if (before == golden.end() || before->second.version != row.version ||
        before->second.options != row.options)
      excused.insert(stage_of(subject));
  }
  for (std::size_t known = 0; known != excused.size();) {
    known = excused.size();
    for (const auto& [stage, input] : inputs)
      if (excused.contains(input)) excused.insert(stage);
  }
  Changes found;
  for (const auto& [subject, row] : now) {
    const auto before = golden.find(subject);
    if (before == golden.end())
      found.excused.push_back(text_of(subject) + " is new");
    else if (before->second.version != row.version)
      found.excused.push_back(fmt::format("{} has version {}, the table {}", text_of(subject), row.version,
                                          before->second.version));
    else if (!agree(row.fingerprint, before->second.fingerprint) && excused.contains(stage_of(subject)))
      found.excused.push_back(text_of(subject) + " comes out otherwise, by its options or by what it reads");
    else if (!agree(row.fingerprint, before->second.fingerprint))
      found.forbidden.push_back(
          fmt::format("{} comes out otherwise under the same version {}: raise the stage's version in the "
                      "table of rules, or artefacts of before pass for new",
                      text_of(subject), row.version));
  }
  for (const auto& [subject, row] : golden)
    if (!now.contains(subject)) found.excused.push_back(text_of(subject) + " is no longer computed");
  return found;
}

TEST(GoldenRules, AFingerprintSeesEachValueAndTheOrder) {
  const Fingerprint base = fingerprint_of({1, 2, 3, 4});
  EXPECT_EQ(base[2], 2.5);
  EXPECT_TRUE(agree(fingerprint_of({1, 2, 3, 4 + 1e-9}), base));
  for (const std::vector<double>& other : std::vector<std::vector<double>>{
           {1, 2, 3, 4.0001}, {1, 3, 2, 4}, {1, 2, 3}, {1, 2, 3, 4, std::nan("")}})
    EXPECT_FALSE(agree(fingerprint_of(other), base));
}

// `map` reads `fpfh`, which reads `normals`: two outputs change.
TEST(GoldenRules, AnotherOutputNeedsAVersionOrOptionsOfItsOwnOrOfAnInput) {
  const Reads inputs = {{"p/fpfh", "p/normals"}, {"p/map", "p/fpfh"}};
  const auto row = [](double mean) { return Golden{1, "0a", {10, 10, mean, 1, 2.5}}; };
  const GoldenTable golden = {{{"p", "fpfh", "mesh", "a"}, row(2)},
                              {{"p", "map", "mesh", "a"}, row(2)},
                              {{"p", "normals", "mesh", "a"}, row(2)}};
  GoldenTable now = golden;
  now[{"p", "fpfh", "mesh", "a"}].fingerprint[2] = 2.00001;
  now[{"p", "map", "mesh", "a"}].fingerprint[2] = 3;
  EXPECT_EQ(changes(now, golden, inputs).forbidden.size(), 2U);
  for (const bool by_options : {false, true}) {
    GoldenTable raised = now;
    Golden& normals = raised[{"p", "normals", "mesh", "a"}];
    by_options ? void(normals.options = "0b") : void(normals.version = 2);
    EXPECT_TRUE(changes(raised, golden, inputs).forbidden.empty());
    EXPECT_EQ(changes(raised, golden, inputs).excused.size(), by_options ? 2U : 3U);
  }
  now[{"p", "fpfh", "mesh", "a"}].options = "0b";
  now[{"p", "normals", "mesh", "a"}].fingerprint[2] = 3;
  EXPECT_EQ(changes(now, golden, inputs).forbidden.size(), 1U) << "nothing excuses what comes before";
  EXPECT_THAT(changes({}, golden, inputs).excused, SizeIs(3));
  EXPECT_THAT(changes(golden, {}, inputs).excused, SizeIs(3));
}

// Records what is saved to a store, sorted by stage and item, independent of the order of threads.
class RecordingStore final : public MemoryStore {
 public:
  struct Before {
    bool operator()(const std::string& a, const std::string& b) const { return natural_less(a, b); }
  };
  void save(std::string_view family, Artefact artefact) override {
    {
      const std::lock_guard lock(mutex_);
      records[artefact.recipe.stage].emplace(artefact.note.item,
                                             std::pair(artefact.recipe, arrays_of(artefact)));
    }
    MemoryStore::save(family, std::move(artefact));
  }
  std::map<std::string, std::multimap<std::string, std::pair<Recipe, Arrays>, Before>> records;

 private:
  std::mutex mutex_;
};

constexpr const char* kCloud = "cloud";  // name of the point cloud among the toy data

std::string options_digest(const Recipe& recipe) {
  Hasher hasher;
  hasher.add(recipe.options);
  hasher.add(recipe.seed);
  return hasher.digest().hex().substr(0, 8);
}

// The fingerprint treats the arrays of all items of one kind as one sequence of values.
void collect(const std::string& protocol, const RecordingStore& store, GoldenTable& golden) {
  std::map<Subject, std::vector<double>> values;
  for (const auto& [stage, records] : store.records)
    for (const auto& [item, record] : records) {
      const Level level = item == "scans" || item.find('_') != item.npos ? kScans
                          : item == "clouds" || item == kCloud           ? kClouds
                                                                         : kMeshes;
      for (const Array& array : record.second) {
        const Subject subject = {protocol, stage, std::string(levels()[level].unit), array.name};
        golden.try_emplace(subject, Golden{record.first.stage_version, options_digest(record.first), {}});
        std::visit([&](const auto& v) { values[subject].insert(values[subject].end(), v.begin(), v.end()); },
                   array.values);
      }
    }
  for (const auto& [subject, all] : values) golden[subject].fingerprint = fingerprint_of(all);
}

// Matching and scoring are one code for all models.
bool is_listed(const std::string& protocol, const std::string& stage) {
  const std::size_t dot = stage.find('.');
  if (dot == stage.npos || stage.starts_with("map.")) return true;
  return protocol == "published" && (stage.ends_with(".PS") || stage.ends_with(".HS"));
}

std::string every_model() {
  std::string yaml = "models:\n";
  for (const ModelRow& row : model_rows()) yaml += "  " + std::string(row.name) + ":\n";
  return yaml;
}

// Large enough for stages that work on part of a shape: the simplification of MS begins at 3000 faces. What
// the protocol of the text has as the published one stands once.
std::pair<GoldenTable, Reads> toy_outputs() {
  const TemporaryFolder data;
  write_toy_item(data.path(), "1", shapes::bumpy_sphere(4, 0.3));
  write_toy_item(data.path(), "2", shapes::bumpy_sphere(3));
  const Mesh points = shapes::bumpy_sphere(3, 0.25);  // its normals are computed
  write_toy_truth(data.path(), kCloud, points);
  data.write(fmt::format("Meshes/{}.ply", kCloud), ply_cloud_text(points.vertices));
  GoldenTable golden;
  Reads inputs;
  for (const std::string protocol : {"published", "text"}) {
    RecordingStore store;
    ToyRun toy(
        data.path(), store,
        "protocol: " + protocol + "\nscan: {step_degrees: 0.5}\npicture: {size: 64}\n" + every_model());
    toy.run();
    for (const Failure& failure : toy.resolver->failures())
      ADD_FAILURE() << toy.project.name(failure.job) << ": " << toy.project.rule(failure.job).stage << ": "
                    << failure.cause;
    collect(protocol, store, golden);
    for (const Rule& rule : toy.project.rules) {
      const std::string shape(levels()[rule.over].unit);
      EXPECT_TRUE(std::ranges::any_of(golden,
                                      [&](const auto& row) {
                                        return row.first[0] == protocol && row.first[1] == rule.stage &&
                                               row.first[2] == shape;
                                      }))
          << rule.stage << " did not run on a " << shape << ": the toy data must reach every rule";
      for (const std::size_t input : rule.inputs)
        inputs.emplace_back(protocol + "/" + rule.stage, protocol + "/" + toy.project.rules[input].stage);
    }
  }
  for (auto row = golden.begin(); row != golden.end();) {
    const Subject published = {"published", row->first[1], row->first[2], row->first[3]};
    const auto other = golden.find(published);
    const bool repeats = other != row && other != golden.end() && repeat(row->second, other->second);
    if (repeats) inputs.emplace_back(stage_of(row->first), stage_of(published));  // has its excuses
    row = repeats || !is_listed(row->first[0], published[1]) ? golden.erase(row) : std::next(row);
  }
  return {golden, inputs};
}

// A few digits suffice: agree() compares six.
GoldenTable rounded(GoldenTable golden) {
  for (auto& [subject, row] : golden)
    for (double& number : row.fingerprint) number = std::stod(fmt::format("{:.10g}", number));
  return golden;
}

// To be run after a stage was added, its version was raised or its options changed; an output that changed
// without any of these is rejected. To accept every output as it is, for example after a change of the toy
// data, remove the rows first.
constexpr auto kToUpdate =
    "SALBENCH_UPDATE_GOLDEN=1 build/release/test_pipeline --gtest_filter='Golden.*' records it";

TEST(Golden, NoOutputChangesUnderTheSameVersion) {
  const fs::path path = SALBENCH_GOLDEN_TABLE;
  const GoldenTable golden = golden_of(read_csv(path));
  EXPECT_EQ(to_csv(table_of(golden)), read_file(path)) << "it reads back as it was written";
  auto [now, inputs] = toy_outputs();
  const bool update = std::getenv("SALBENCH_UPDATE_GOLDEN") != nullptr;
  const Changes found = changes(now, golden, inputs);
  for (const std::string& what : found.forbidden) ADD_FAILURE() << what;
  if (!update)
    for (const std::string& what : found.excused) ADD_FAILURE() << what << ": " << kToUpdate;
  if (!update || HasFailure()) return;
  now = rounded(std::move(now));
  for (auto& [subject, row] : now)  // ignores differences in the last digits between machines
    if (const auto before = golden.find(subject);
        before != golden.end() && agree(row.fingerprint, before->second.fingerprint))
      row.fingerprint = before->second.fingerprint;
  write_file(path, to_csv(table_of(now)));
}

}  // namespace
}  // namespace salbench
