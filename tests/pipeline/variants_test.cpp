// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/rules/variants.h"

#include "tests/support/memory_store.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"
#include "tests/support/toy_data.h"

namespace salbench {
namespace {

Config of_models(const std::string& models) {
  return read_config(Section::from_text("models: " + models, "x.yaml"), "x");
}

std::vector<std::string> names_in(const Config& config) {
  std::vector<std::string> names;
  for (const Model& model : config.models) names.push_back(model.name);
  return names;
}

TEST(Variants, EveryModelThatIsNoReferenceHasThem) {
  for (const ModelRow& row : model_rows()) {
    if (row.about.is_reference) continue;
    const Config config = of_models(fmt::format("{{V: {{model: {}}}}}", row.name));
    EXPECT_EQ(config.models.at(0).options,
              fmt::format("model: {}\n", row.name) +
                  row.bind(Section::from_text("", ""), Protocol::published).options);
  }
}

TEST(Variants, TheirOtherOptionsAreThoseOfTheirModel) {
  const Config config =
      of_models("{LS: {foci_share: 0.2, foci_sigma: 0.1}, LS-08: {model: LS, foci_sigma: 0.08}}");
  EXPECT_THAT(names_in(config), ElementsAre("LS", "LS-08"));
  EXPECT_THAT(config.models[1].options, HasSubstr("foci_share: 0.2\nfoci_sigma: 0.08\n"));
  const Config text = read_config(Section::from_text("protocol: text\nmodels: {V: {model: PS}}", ""), "");
  EXPECT_EQ(text.models[0].options, "model: PS\nabsolute: true\n");
}

TEST(Variants, AGridMakesNamesOfItsValues) {
  struct Row {
    std::string_view section;
    std::vector<std::string> names;
  };
  const Row rows[] = {
      {"{model: LS, grid: {foci_sigma: [0.05, 0.08]}}", {"G-0_05", "G-0_08"}},
      {"{model: LS, grid: {foci_sigma: [0.50]}}", {"G-0_5"}},
      {"{model: LS, grid: {foci_sigma: [1e-5, 2e22]}}", {"G-1e-05", "G-2e_22"}},
      {"{model: PS, grid: {absolute: [true, false]}}", {"G-true", "G-false"}},
      {"{model: MC, grid: {curvature: [taubin]}}", {"G-taubin"}},
      {"{model: LS, grid: {foci_sigma: [1, 2], foci_share: [0.1, 0.2]}}",
       {"G-1-0_1", "G-1-0_2", "G-2-0_1", "G-2-0_2"}},
  };
  for (const Row& row : rows)
    EXPECT_EQ(names_in(of_models(fmt::format("{{G: {}}}", row.section))), row.names);
}

std::string list_to(int n) {
  std::string list;
  for (int i = 1; i <= n; ++i) list += fmt::format("{}{}", i > 1 ? ", " : "", i);
  return list;
}

TEST(Variants, WhatCannotBeOneIsAnError) {
  const struct {
    std::string models, error;
  } rows[] = {
      {"{A: {model: XS}}", "models.A.model is 'XS', not one of LS, CS,"},
      {"{A: {model: RS}}", "models.A.model is 'RS', not one of"},
      {"{A: {model: LS, sigma: 1}}", "models.A.sigma is not a known key"},
      {"{A b: {model: LS}}", "models.A b must be 1 to 40 letters"},
      {"{ls: {model: LS}}", "models.ls is the name of something else"},
      {"{LS: {model: LS}}", "models.LS.model is a key of variants"},
      {"{LS: {grid: {foci_sigma: [1]}}}", "models.LS.grid is a key of variants"},
      {"{A: {grid: {foci_sigma: [1]}}}", "models.A is not a known model"},
      {"{A: {model: LS, grid: }}", "models.A.grid must be a mapping of options to lists"},
      {"{A: {model: LS, grid: {foci_sigma: 1}}}", "models.A.grid.foci_sigma must be a list of values"},
      {"{A: {model: LS, grid: {foci_sigma: []}}}", "models.A.grid.foci_sigma is an empty list"},
      {"{A: {model: LS, foci_sigma: 1, grid: {foci_sigma: [2]}}}", "the key 'foci_sigma' is given twice"},
      {"{A: {model: LS, grid: {foci_sigma: [1, 1.0]}}}", "models.A.grid makes two models called 'A-1'"},
      {"{A: {model: LS, grid: {foci_sigma: [1]}}, A-1: {model: CS}}", "models.A-1 is the name of two models"},
      {fmt::format("{{{}: {{model: PS, grid: {{absolute: [true]}}}}}}", std::string(39, 'a')),
       "which must be 1 to 40"},
      {fmt::format("{{A: {{model: LS, grid: {{foci_sigma: [{0}], foci_share: [{0}]}}}}}}", list_to(32)),
       "models.A.grid has more than the 1000 combinations"},
  };
  for (const auto& row : rows)
    EXPECT_THAT([&] { of_models(row.models); }, Refuses<ConfigError>("x.yaml:1: ", row.error)) << row.models;
}

TEST(Variants, TheyShareWhatIsNotTheirOwnAndFindTheMapsOfTheirModel) {
  TemporaryFolder data;
  write_toy_item(data.path(), "1", shapes::bumpy_sphere(2));
  MemoryStore store;
  const auto computed = [&](const std::string& models) {
    ToyRun(data.path(), store, toy_config("dataset: {scans: false}\nmodels: " + models)).run();
    return store.take_saved();
  };
  computed("{LS: {foci_sigma: 0.1}, RS: }");
  const auto variant = computed("{LS-2: {model: LS, foci_sigma: 0.2}, RS: }");
  EXPECT_THAT(variant, Contains("map.LS-2@1"));
  EXPECT_THAT(variant, Each(HasSubstr("LS-2"))) << "descriptors are those of LS";
  const auto same = computed("{LS-1: {model: LS, foci_sigma: 0.1}, RS: }");
  EXPECT_THAT(same, Not(Contains(StartsWith("map.")))) << "that of LS";
  EXPECT_THAT(same, Contains("scores.LS-1@1"));
}

}  // namespace
}  // namespace salbench
