// SPDX-License-Identifier: GPL-3.0-or-later
// CONTRIBUTING.md, followed: a stage, a model and a data set from outside are added in one place each, and
// take part like built-in ones. For a metric: metrics_test.cpp.
#include <atomic>
#include <thread>

#include "pipeline/results/tables.h"
#include "stages/geometry/mesh_ops.h"
#include "tests/support/job_counts.h"
#include "tests/support/memory_store.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"
#include "tests/support/toy_data.h"

namespace salbench {
namespace {

// --- a model: its function, and a row of the table -------------------------------------------------------

struct FarOptions {
  double power = 1;

  static FarOptions text() { return {.power = 2}; }

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("power", self.power, {"of the distance"});
  }
};

ScalarField far_saliency(Points points, const FarOptions& options) {
  const Vec3 centre = centroid(points);
  ScalarField saliency;
  for (const Vec3& p : points) saliency.push_back(std::pow((p - centre).norm(), options.power));
  return saliency;
}

Model far_model(const std::string& yaml, Protocol protocol) {
  return model_row("FAR", 1, {.name = "Distance"}, far_saliency)
      .bind(Section::from_text(yaml, "far.yaml"), protocol);
}

TEST(AddAModel, ItsSectionIsReadOverTheProtocolsDefaults) {
  EXPECT_EQ(far_model("", Protocol::published).options, "power: 1\n");
  EXPECT_EQ(far_model("", Protocol::text).options, "power: 2\n");
  EXPECT_EQ(far_model("power: 3", Protocol::text).options, "power: 3\n");
  EXPECT_THROW(far_model("powr: 3", Protocol::text), ConfigError);
}

struct TwofoldOptions {
  double power = 1, power_of_scans = 2;

  TwofoldOptions of_meshes() const { return {power, 0}; }
  TwofoldOptions of_scans() const { return {power_of_scans, 0}; }

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("power", self.power, {"of the distance"});
    visit("power_of_scans", self.power_of_scans, {"the same on scans", {}, {}, "0"});
  }
};

ScalarField twofold_saliency(Points points, const TwofoldOptions& options) {
  return far_saliency(points, {options.power});
}

TEST(AddAModel, ItsOptionsMayDifferOnScansAndEachKeyHasThoseThatCount) {
  Config config = toy_config();
  config.models = {
      model_row("TWO", 1, {}, twofold_saliency).bind(Section::from_text("", ""), Protocol::published)};
  const Rules rules = make_rules(config);
  const auto in_key = [&](Level level) {
    return rules[find_rule(rules, level, "map.TWO")].options.at(0).in_key;
  };
  EXPECT_EQ(in_key(kMeshes), "power: 1\n");
  EXPECT_EQ(in_key(kScans), "power: 2\n");
  EXPECT_EQ(config.models[0].options, "power: 1\npower_of_scans: 2\n");
}

TEST(AddAModel, ItIsMappedMatchedScoredAndReported) {
  TemporaryFolder data;
  write_toy_item(data.path(), "1", shapes::bumpy_sphere(2));
  MemoryStore store;
  {
    ToyRun others(data.path(), store);
    others.run();
    store.take_saved();
  }
  Config config = toy_config();
  config.models.push_back(far_model("", Protocol::published));
  ToyRun run(data.path(), store, config);
  run.run();
  // Other models are not affected.
  const auto computed = store.take_saved();
  const JobCounts jobs(config, 1);
  EXPECT_THAT(computed, SizeIs(jobs.of("map.FAR") + jobs.of("matched.FAR") + jobs.of("scores.FAR") +
                               jobs.of("score_table.FAR") + jobs.of("mean_histogram.FAR")));
  EXPECT_THAT(computed, Each(HasSubstr("FAR")));
  const auto rows = run.results();
  const auto scored =
      std::count_if(rows.begin(), rows.end(), [](const ResultRow& row) { return row.model == "FAR"; });
  EXPECT_EQ(static_cast<std::size_t>(scored), jobs.shapes());
  EXPECT_THAT(to_csv(means_table(rows, chosen_metrics({}))), HasSubstr("meshes,auc,FAR,1,"));
}

// --- inputs of a rule follow from its signature -----------------------------------------------------------

ScalarField of_everything(Points, const Normals&, Surface, const Descriptors&, const RandomSource&,
                          const FarOptions&) {
  return {};
}

TEST(AddAModel, ItReadsWhatItsSignatureNames) {
  Config config = toy_config("models: {RS: }");
  config.models = {model_row("ALL", 3, {}, of_everything).bind(Section::from_text("", ""), Protocol::text)};
  const Rules rules = make_rules(config);
  const auto inputs_of = [&](Level level) {
    std::vector<std::string> names;
    for (const std::size_t input : rules[find_rule(rules, level, "map.ALL")].inputs)
      names.push_back(rules[input].stage);
    return names;
  };
  EXPECT_THAT(inputs_of(kMeshes), ElementsAre("mesh", "normals", "mesh", "fpfh"));
  EXPECT_THAT(inputs_of(kScans), ElementsAre("scan", "scan_normals", "surface", "fpfh"));
  const Rule& rule = rules[find_rule(rules, kScans, "map.ALL")];
  EXPECT_TRUE(rule.seeded);
  EXPECT_EQ(rule.version, 3);
  EXPECT_EQ(rule.kind, "field");
  EXPECT_EQ(rule.options[0].section, "models.ALL");
  EXPECT_EQ(rule.options[0].text, "power: 2\n");
}

// --- a stage: its function, and a row of the table of rules -----------------------------------------------

ScalarField heights(const Mesh& mesh, const FarOptions& options) {
  ScalarField z;
  for (const Vec3& p : mesh.vertices) z.push_back(p.z() * options.power);
  return z;
}

template <class Add>
void add_to(ToyRun& toy, const Add& add) {
  RuleTable table(std::move(toy.project.rules));
  add(table);
  toy.project.rules = std::move(table).take();
  toy.make_plan_again();
}

TEST(AddAStage, ItIsComputedStoredAndFoundAgain) {
  TemporaryFolder data;
  write_toy_item(data.path(), "1", shapes::bumpy_sphere(2));
  MemoryStore store;
  const auto computed = [&](double power) {
    ToyRun toy(data.path(), store);
    const Output<Mesh> mesh(toy.index("mesh"));
    add_to(toy, [&](RuleTable& table) {
      table.add(kMeshes, {.stage = "heights"}, heights, mesh, section("heights", FarOptions{power}));
    });
    toy.run();
    const ValuePtr value = toy.resolver->value({toy.index("heights"), mesh_unit(0)});
    EXPECT_EQ(value_as<ScalarField>(*value).size(), shapes::bumpy_sphere(2).vertices.size());
    return store.take_saved();
  };
  EXPECT_THAT(computed(1), Contains("heights@1"));
  EXPECT_THAT(computed(1), IsEmpty());
  EXPECT_THAT(computed(2), ElementsAre("heights@1"));
}

// Built from a mesh for all its views; counts instances built and alive.
struct Sized {
  static inline std::atomic<int> made = 0, left = 0;
  std::size_t n;

  explicit Sized(const Mesh& mesh) : n(mesh.vertices.size()) { ++made, ++left; }
  Sized(const Sized&) = delete;
  Sized& operator=(const Sized&) = delete;
  ~Sized() { --left; }
};

ScalarField of_view(const Sized& mesh, const UnitPlace& view, const FarOptions&) {
  return ScalarField(mesh.n, view.index);
}

TEST(AddAStage, WhatItsViewsShareIsMadeOncePerMeshAndGoesWithIt) {
  TemporaryFolder data;
  for (const int size : {1, 2, 3}) {  // equal meshes would have equal keys, and be computed once
    Mesh mesh = shapes::bumpy_sphere(2);
    for (Vec3& vertex : mesh.vertices) vertex *= size;
    write_toy_item(data.path(), std::to_string(size), mesh);
  }
  MemoryStore store;
  ToyRun toy(data.path(), store);
  const Output<Mesh> mesh(toy.index("mesh"));
  add_to(toy, [&](RuleTable& table) {
    table.add(kScans, {.stage = "of_view"}, of_view, prepared<Sized>(mesh), kPlace,
              section("of_view", FarOptions{}));
  });
  const int made_before = Sized::made;  // by other tests
  toy.run(1);
  EXPECT_EQ(Sized::made - made_before, 3);
  EXPECT_EQ(Sized::left, 0);
  const std::size_t rule = toy.index("of_view", kScans);
  for (int view = 0; view < kViews; ++view)
    EXPECT_EQ(value_as<ScalarField>(*toy.resolver->value({rule, scan_unit(2, view)})),
              ScalarField(shapes::bumpy_sphere(2).vertices.size(), view));
}

// --- a data set: a file of Python --------------------------------------------------------------------------

TEST(AddADataSet, ItIsOneFile) {
  const TemporaryFolder folder;
  folder.write("data/ply/statue.off", off_text(shapes::tetrahedron()));
  folder.write("data/fixations/statue.val", "0\n1\n0\n0\n");
  const auto scanner = folder.write("scanner.py", R"(from salbench.datasets import Item, match

def items(root):
    return [Item(one.item, [one.path], saliency=f"{root}/fixations/{one.item}.val")
            for one in match(root, "ply/{item}.off")]
)");
  const Config config = toy_config("dataset: {layout: " + scanner.string() + "}");
  const Dataset dataset = find_dataset(folder / "data", config.dataset.layout, front_of_tests());
  EXPECT_EQ(dataset.layout, "scanner");
  ASSERT_THAT(dataset.items, SizeIs(1));
  EXPECT_EQ(dataset.items[0].saliency, folder / "data/fixations/statue.val");
}

}  // namespace
}  // namespace salbench
