// SPDX-License-Identifier: GPL-3.0-or-later
// Runs over the layouts that the program lists by itself, and over what importers make: their readers are
// tested in tests/datasets.
#include "tests/pipeline/data_sets.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/core/seen.h"

namespace salbench {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::IsNan;
using testing::SizeIs;

const Mesh kSphere = shapes::bumpy_sphere(2);

// A value per vertex of another shape each time.
ScalarField heights(const Mesh& mesh, double offset) {
  ScalarField values;
  for (const Vec3& v : mesh.vertices) values.push_back(std::abs(v.z() + offset));
  return values;
}

std::string lines_of(const ScalarField& values) {
  std::string text;
  for (const double value : values) text += fmt::format("{}\n", value);
  return text;
}

// --- layouts -------------------------------------------------------------------------

TEST_F(DataSets, Schelling) {
  write_toy_item(data_.path(), "21", kSphere);
  for (const char* layout : {"schelling", "automatic"}) {
    run(layout);
    EXPECT_THAT(failures(), IsEmpty());
    EXPECT_THAT(truth().picks, SizeIs(4));
    EXPECT_EQ(item_of(toy_->inputs.units, mesh_unit(0)).category, "cup");
    EXPECT_TRUE(std::isfinite(score_of("HS", "nss")));
  }
}

// --- viewers ----------------------------------------------------------------------------------------------

constexpr const char* kViewers =
    "places: [{meshes: 'off/*', truth: {saliency: 'maps/{item}_{viewer}.csv'}}]\n";

TEST_F(DataSets, ViewersMakeTheGroundTruthAndHumanPerformance) {
  data_.write("off/cat.off", off_text(kSphere));
  for (int k = 0; k < 5; ++k)
    data_.write(fmt::format("maps/cat_{}.csv", k), lines_of(heights(kSphere, 0.1 * k)));
  run(description(kViewers));
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_THAT(truth().viewers, SizeIs(5));
  EXPECT_EQ(truth().viewers[3], heights(kSphere, 0.1 * 3));
  EXPECT_EQ(truth().saliency, mean_of_seen(truth().viewers, std::vector<std::size_t>{0, 1, 2, 3, 4}));
  EXPECT_GT(score_of("HS", "cc"), 0.5) << "people who see much the same agree";
  EXPECT_THAT(score_of("HS", "nss"), IsNan()) << "nobody picked a point";
}

TEST_F(DataSets, OneViewerIsNoHumanPerformance) {
  data_.write("off/cat.off", off_text(kSphere));
  data_.write("maps/cat_0.csv", lines_of(heights(kSphere, 0)));
  run(description(kViewers));
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_THAT(truth().viewers, IsEmpty());
  EXPECT_EQ(truth().saliency, heights(kSphere, 0));
}

// --- keys -------------------------------------------------------------------------------------------------

TEST_F(DataSets, HowFilesAreReadIsPartOfTheKeyUnlessItIsAsEver) {
  write_toy_item(data_.path(), "21", kSphere);
  const auto names = [&](const std::string& yaml) {
    run(yaml.empty() ? "schelling" : description(yaml));
    std::vector<std::string> found;
    for (const File& file : toy_->inputs.truth_files->at(0)) found.push_back(file.name);
    return found;
  };
  const std::string places =
      "places: [{meshes: 'Meshes/*', truth: {saliency: 'Distributions/{item}.val', picks: "
      "'RawData/{item}_{participant}.pid'}}]\n";
  const auto as_ever = names("");
  EXPECT_THAT(as_ever, ElementsAre("saliency file", "picks 0", "picks 1", "picks 2", "picks 3"));
  EXPECT_EQ(names(places), as_ever);
  store_.take_saved();
  run(description(places));
  EXPECT_THAT(store_.take_saved(), IsEmpty()) << "what the program's own description led to is found";
  run(description(places + "values: {column: 1, unseen: -1}\n"));
  EXPECT_EQ(toy_->inputs.shape_files->at(0).at(1).name,
            "saliency file (column: 1, unseen: -1), rows by their numbers");
}

}  // namespace
}  // namespace salbench
