// SPDX-License-Identifier: GPL-3.0-or-later
// Point clouds in columns of a text, with their ground truth.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/core/errors.h"
#include "tests/pipeline/data_sets.h"

namespace salbench {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::StartsWith;

class InColumns : public DataSets {
 protected:
  static constexpr const char* kColumns =
      "columns: {position: [1, 2, 3], normal: [4, 5, 6], density: 7, flag: 8, normalise_normals: true, "
      "padding: any";

  // 12 points on a helix, with directions twice as long as normals.
  InColumns() {
    for (int i = 0; i < 12; ++i)
      lines_.push_back(fmt::format("{} {} {} {} {} 0 {} {}\n", std::cos(i), std::sin(i), 0.1 * i,
                                   20 * std::cos(i), 20 * std::sin(i), 0.5 * i, i % 5 == 2 ? 1 : 0));
  }
  std::string described(const std::string& more = "") {
    return description(
        fmt::format("domain: points\nplaces: [{{meshes: 'Gaze/*'}}]\n{}{}}}\n", kColumns, more));
  }
  void run_lines(const std::string& layout) {
    data_.write("Gaze/cat.txt", fmt::format("{}", fmt::join(lines_, "")));
    run(layout);
  }
  GroundTruth cloud_truth() const {
    return value_as<GroundTruth>(
        *toy_->resolver->value({toy_->index("cloud_ground_truth", kClouds), Unit{kClouds, 0}}));
  }
  PointCloud cloud() const {
    return value_as<PointCloud>(*toy_->resolver->value({toy_->index("cloud", kClouds), Unit{kClouds, 0}}));
  }

  std::vector<std::string> lines_;
};

TEST_F(InColumns, PositionNormalDensityAndFlagAreRead) {
  run_lines(described());
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_THAT(cloud().points, SizeIs(12));
  EXPECT_EQ(cloud().points[3], Vec3(std::cos(3), std::sin(3), 0.1 * 3));
  EXPECT_NEAR((cloud().normals[3] - Vec3(std::cos(3), std::sin(3), 0)).norm(), 0, 1e-12);
  EXPECT_EQ(cloud_truth().saliency[5], 2.5);
  EXPECT_THAT(cloud_truth().picks, ElementsAre(ElementsAre(2, 7)));
  EXPECT_EQ(toy_->results()[0].dataset, "clouds");
  EXPECT_EQ(toy_->results()[0].scores.n_points, 12);
}

TEST_F(InColumns, PaddingAndDuplicatesAreLeftOutWithTheirTruth) {
  lines_.insert(lines_.begin() + 4, lines_[2]);
  lines_.push_back("0 0 0 0 0 0 0 0\n");
  lines_.insert(lines_.end(), 2, lines_[1]);
  lines_.insert(lines_.end(), 2, "0 0 0 0 0 0 0 0\n");
  run_lines(described(", duplicates: dropped"));
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_THAT(cloud().points, SizeIs(12));
  EXPECT_THAT(cloud().dropped, ElementsAre(4, 13, 14, 15, 16, 17));
  EXPECT_EQ(cloud_truth().saliency[5], 2.5);
  EXPECT_THAT(cloud_truth().picks, ElementsAre(ElementsAre(2, 7)));
}

TEST_F(InColumns, DirectionsOfAnyLengthAreAnErrorUnlessTheyAreToBeNormalised) {
  data_.write("Gaze/cat.txt", fmt::format("{}", fmt::join(lines_, "")));
  run(description(
      "places: [{meshes: 'Gaze/*'}]\ncolumns: {position: [1, 2, 3], normal: [4, 5, 6], density: 7}\n"));
  EXPECT_THAT(failures(), ElementsAre(AllOf(StartsWith(place("Gaze/cat.txt") + ":1: the normal"),
                                            HasSubstr("normalise_normals"))));
}

TEST_F(InColumns, WrongFlagsAndShortLinesAreNamed) {
  lines_[3] = "1 1 1 1 0 0 0.5 0.5\n";
  run_lines(described());
  EXPECT_THAT(failures(), ElementsAre(StartsWith(place("Gaze/cat.txt") + ":4: the flag is neither 0 nor 1")));
  lines_[3] = "1 1 1 1 0 0 0.5\n";
  run_lines(described());
  EXPECT_THAT(failures(), ElementsAre(StartsWith(place("Gaze/cat.txt") + ":4: the line has 7 columns")));
}

TEST_F(InColumns, WhichColumnsAreReadIsPartOfTheKeys) {
  run_lines(described());
  const auto names = [&] {
    return std::pair(toy_->inputs.shape_files->files[0][0].name, toy_->inputs.truth_files->files[0][0].name);
  };
  EXPECT_EQ(
      names().first,
      "point cloud file .txt (position: [1, 2, 3], normal: [4, 5, 6], normalise_normals: true, padding: "
      "any, density: 7, flag: 8)");
  EXPECT_EQ(names().second, "ground truth in columns (density: 7, flag: 8)");
}

TEST_F(InColumns, ACommaSeparatedTextWithAHeaderIsReadByName) {
  data_.write("Gaze/cat.csv",
              "d,x,y,z\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n5,1,1,0\n6,1,0,1\n7,0,1,1\n8,1,1,1\n9,2,0,0\n");
  run(description("places: [{meshes: 'Gaze/*'}]\ncolumns: {position: [x, y, z], density: d}\n"));
  EXPECT_EQ(cloud().points[2], Vec3(0, 1, 0));
  EXPECT_EQ(cloud_truth().saliency, (ScalarField{1, 2, 3, 4, 5, 6, 7, 8, 9}));
}

}  // namespace
}  // namespace salbench
