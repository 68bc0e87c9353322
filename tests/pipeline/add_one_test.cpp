// SPDX-License-Identifier: GPL-3.0-or-later
// CONTRIBUTING.md, followed: a stage and a model from outside are added in one place each, and take part like
// built-in ones. For a metric: metrics_test.cpp. For a data set: imports_test.cpp.
#include <atomic>

#include "stages/geometry/mesh_ops.h"
#include "tests/pipeline/runner_fixture.h"
#include "tests/support/test.h"

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

TEST(AddAModel, ItsOptionsMayDifferOnScansAndEachKeyHasThoseThatCount) {
  const Config config = toy_config("models: {LS: {selected_share_of_scans: 0.3}}");
  const Rules rules = make_rules(config);
  const auto in_key = [&](Level level) {
    return rules[find_rule(rules, level, "map.LS")].options.at(0).in_key;
  };
  EXPECT_THAT(in_key(kMeshes), AllOf(HasSubstr("selected_share: 0.05\n"), Not(HasSubstr("of_scans"))));
  EXPECT_THAT(in_key(kScans), AllOf(HasSubstr("selected_share: 0.3\n"), Not(HasSubstr("of_scans"))));
  EXPECT_THAT(config.models[0].options, HasSubstr("selected_share_of_scans: 0.3\n"));
}

TEST_F(RunnerTest, AModelIsMappedMatchedScoredAndReported) {
  run();
  Config config = toy_config();
  config.models.push_back(far_model("", Protocol::published));
  const auto computed = run(config);
  // Other models are not affected.
  EXPECT_THAT(computed, SizeIs(JobCounts(config, 2).of_model("FAR")));
  EXPECT_THAT(computed, Each(HasSubstr("FAR")));
  const auto rows = toy_->results();
  EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(rows, "FAR", &ResultRow::model)), jobs_.shapes());
  EXPECT_THAT(to_csv(means_table(rows, metrics())), HasSubstr("meshes,auc,FAR,2,"));
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

TEST_F(RunnerTest, AStageIsComputedStoredAndFoundAgain) {
  const auto computed = [&](double power) {
    ToyRun toy(data_.path(), store_);
    const Output<Mesh> mesh(toy.index("mesh"));
    add_to(toy, [&](RuleTable& table) {
      table.add(kMeshes, {.stage = "heights"}, heights, mesh, section("heights", FarOptions{power}));
    });
    toy.run();
    EXPECT_THAT(toy.value<ScalarField>("heights", mesh_unit(0)),
                SizeIs(shapes::bumpy_sphere(2).vertices.size()));
    return store_.take_saved();
  };
  EXPECT_THAT(computed(1), Contains("heights@1"));
  EXPECT_THAT(computed(1), IsEmpty());
  EXPECT_THAT(computed(2), ElementsAre("heights@1", "heights@2"));
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

TEST_F(RunnerTest, WhatTheViewsOfAStageShareIsMadeOncePerMeshAndGoesWithIt) {
  ToyRun toy(data_.path(), store_);
  const Output<Mesh> mesh(toy.index("mesh"));
  add_to(toy, [&](RuleTable& table) {
    table.add(kScans, {.stage = "of_view"}, of_view, prepared<Sized>(mesh), kPlace,
              section("of_view", FarOptions{}));
  });
  const int made_before = Sized::made;  // by other tests
  toy.run(1);
  EXPECT_EQ(Sized::made - made_before, 2);
  EXPECT_EQ(Sized::left, 0);
  for (int view = 0; view < kViews; ++view)
    EXPECT_EQ(toy.value<ScalarField>("of_view", scan_unit(1, view)),
              ScalarField(shapes::bumpy_sphere(2).vertices.size(), view));
}

}  // namespace
}  // namespace salbench
