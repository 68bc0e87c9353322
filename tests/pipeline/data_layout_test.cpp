// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/config/data_layout.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/core/errors.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/toy_data.h"

namespace salbench {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

std::string error_of(const std::string& yaml) {
  try {
    read_layout(Section::from_text(yaml, "own.yaml"), "own");
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

std::string error_of_place(const std::string& place) { return error_of("places:\n  - " + place + "\n"); }

TEST(DataLayout, EveryDescriptionOfTheProgramCanBeRead) {
  for (const std::string_view name : layout_names()) {
    if (name == kAutomaticLayout) continue;
    const std::vector<Layout> layouts = layouts_of(std::string(name));
    ASSERT_EQ(layouts.size(), 1U) << name;
    EXPECT_EQ(layouts[0].name, name);
    for (const Place& place : layouts[0].places) {
      EXPECT_THAT(place.meshes.where, StartsWith("configs/datasets/" + std::string(name) + ".yaml:"));
      EXPECT_FALSE(place.truth.empty() && !layouts[0].format.columns.has_truth()) << name;
    }
  }
}

TEST(DataLayout, AutomaticTriesThoseThatSaySoInTheirOrder) {
  std::vector<std::string> names;
  for (const Layout& layout : layouts_of("automatic")) names.push_back(layout.name);
  EXPECT_THAT(names, ElementsAre("gs", "schelling", "princeton", "folder"));
}

TEST(DataLayout, WhatAFileSaysIsRead) {
  const TemporaryFolder folder;
  const auto path = folder.write("own.yaml",
                                 "classes: folder\n"
                                 "places:\n"
                                 "  - needs: maps\n"
                                 "    meshes: shapes/*/*.obj\n"
                                 "    truth: {saliency: 'maps/{item}_{viewer}.csv'}\n"
                                 "values: {per: point, column: s, points: [x, y, z], max_distance: 0.1}\n"
                                 "indices: {base: 1}\n");
  const std::vector<Layout> layouts = layouts_of(path.string());
  ASSERT_EQ(layouts.size(), 1U);
  const Layout& layout = layouts[0];
  EXPECT_EQ(layout.name, "own");
  EXPECT_EQ(layout.classes, Classes::folder);
  EXPECT_TRUE(layout.needs_truth);
  ASSERT_EQ(layout.places.size(), 1U);
  EXPECT_EQ(layout.places[0].needs, "maps");
  EXPECT_EQ(layout.places[0].meshes.text, "shapes/*/*.obj");
  EXPECT_EQ(layout.places[0].meshes.where, path.string() + ":4");
  EXPECT_EQ(layout.places[0].truth[0].saliency.text, "maps/{item}_{viewer}.csv");
  EXPECT_EQ(layout.format.values.per, ValuePer::point);
  EXPECT_EQ(layout.format.values.column, "s");
  EXPECT_THAT(layout.format.values.points, ElementsAre("x", "y", "z"));
  EXPECT_EQ(layout.format.indices.base, 1);
}

TEST(DataLayout, NamesFileLineAndWhatWasExpected) {
  EXPECT_EQ(error_of("classes: none\n"),
            "own.yaml:1: places is missing; expected a list of places with meshes");
  EXPECT_EQ(error_of("index: index.csv\nplaces: [{meshes: 'off/*'}]\n"),
            "own.yaml:1: index is there beside `places`: a set is in the one form or in files of its own");
  EXPECT_EQ(error_of("place: []\n"), "own.yaml:1: place is not a known key; did you mean 'places'?");
  EXPECT_EQ(error_of("\nplaces: off\n"), "own.yaml:2: places must be a list of mappings");
  EXPECT_EQ(error_of_place("off"), "own.yaml:2: places[0] must be a mapping of keys to values");
  EXPECT_EQ(error_of_place("truth: {picks: '{item}.pid'}"),
            "own.yaml:2: places[0].meshes is missing; expected a pattern such as Meshes/*");
  EXPECT_EQ(error_of_place("{meshes: 'off/*', truht: }"),
            "own.yaml:2: places[0].truht is not a known key; did you mean 'truth'?");
  EXPECT_EQ(
      error_of_place("meshes: /off/*"),
      "own.yaml:2: places[0].meshes '/off/*' must be relative to the folder of the data set, without an "
      "empty name in it");
  EXPECT_EQ(
      error_of_place("meshes: off/*\n    truth:\n      saliency: maps/{itm}.csv"),
      "own.yaml:4: places[0].truth.saliency 'maps/{itm}.csv' has braces around something other than item, "
      "participant, view or viewer");
  EXPECT_EQ(
      error_of_place("meshes: off/*\n    truth:\n      picks: maps/*.pid"),
      "own.yaml:4: places[0].truth.picks 'maps/*.pid' must have {item} in place of the name of the item");
  EXPECT_EQ(error_of_place("meshes: off/*\n    truth: {}"),
            "own.yaml:3: places[0].truth names neither saliency nor picks");
  EXPECT_EQ(error_of("places: [{meshes: '*'}]\nvalues:\n  per: edge\n"),
            "own.yaml:3: values.per is 'edge', not one of vertex, face, point");
  EXPECT_EQ(error_of("places: [{meshes: '*'}]\nvalues: {unseen: none}\n"),
            "own.yaml:2: values.unseen is 'none', not a number or nan");
  EXPECT_THAT(error_of("places: [{meshes: '*'}]\nvalues: {per: point}\n"),
              HasSubstr("own.yaml:2: values.column"));
  EXPECT_EQ(error_of("places: [{meshes: '*'}]\nvalues: {points: [x, y]}\n"),
            "own.yaml:2: values.points must be three columns, of x, y and z");
  EXPECT_THAT(error_of("places: [{meshes: '*'}]\nindices: {base: 2}\n"),
              HasSubstr("own.yaml:2: indices.base"));
  EXPECT_THAT(error_of("places: [{meshes: '*'}]\nindices: {cell: [0, 8]}\n"),
              HasSubstr("own.yaml:2: indices.cell must be a row and a column, from 1"));
  EXPECT_EQ(error_of("domain: faces\nplaces: [{meshes: '*'}]\n"),
            "own.yaml:1: domain is 'faces', not one of any, meshes, points");
}

std::string error_of_config(const std::string& yaml) {
  try {
    toy_config(yaml);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

TEST(DataLayout, AConfigurationNamesOneOrAFile) {
  EXPECT_EQ(toy_config("").dataset.layout, "automatic");
  EXPECT_EQ(toy_config("dataset: {layout: 3dva}").dataset.layout, "3dva");
  EXPECT_THAT(error_of_config("dataset:\n  layout: 3dav\n"),
              AllOf(StartsWith("toy.yaml:2: dataset.layout is '3dav', expected one of automatic, 3dva, "),
                    HasSubstr("or a file NAME.yaml")));
  EXPECT_THAT([] { layouts_of("/no/such/own.yaml"); },
              testing::ThrowsMessage<ConfigError>(StartsWith("/no/such/own.yaml: ")));
}

TEST(DataLayout, AConfigurationIsWrittenAndReadBackWhateverTheFilesName) {
  for (const char* name : {"schelling", "my data/it's: own #1.yaml", "/a/b-c_d.yaml", "\"q\".yaml"}) {
    Config config = toy_config("");
    config.dataset.layout = name;
    EXPECT_EQ(toy_config(config_yaml(config)).dataset.layout, name);
  }
  EXPECT_THAT(config_yaml(toy_config("dataset: {layout: schelling}")), HasSubstr("  layout: schelling\n"));
}

}  // namespace
}  // namespace salbench
