// SPDX-License-Identifier: GPL-3.0-or-later
// Ground truth of what a camera saw: visibility that is computed, where an archive has no masks.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/inputs/inspection.h"
#include "stages/core/errors.h"
#include "tests/pipeline/data_sets.h"

namespace salbench {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;
using testing::ThrowsMessage;

// A sphere of radius 1 around (10, 0, 0).
class WithCameras : public DataSets {
 protected:
  WithCameras() {
    for (Vec3& v : sphere_.vertices) v.x() += 10;
    data_.write("off/cat.off", off_text(sphere_));
    std::string values;
    for (std::size_t i = 0; i < sphere_.vertices.size(); ++i) values += fmt::format("{}\n", i % 7);
    for (const char* view : {"front", "top"}) data_.write(fmt::format("maps/cat_{}.txt", view), values);
  }
  std::string described(const std::string& cameras, const std::string& views = "scored") {
    return description(
        fmt::format("places:\n  - meshes: off/*\n    views: {}\n    truth:\n      saliency: "
                    "maps/{{item}}_{{view}}.txt\n      {}\n",
                    views, cameras));
  }
  // True if exactly the vertices on that side of the sphere were seen, but for those that are edge-on.
  bool sees_side(const GroundTruth& truth, const Vec3& direction, double from_height = 0) const {
    for (std::size_t i = 0; i < truth.saliency.size(); ++i) {
      const double height = (sphere_.vertices[i] - Vec3(10, 0, 0)).dot(direction.normalized()) - from_height;
      if (std::abs(height) > 0.3 && std::isnan(truth.saliency[i]) != (height < 0)) return false;
    }
    return true;
  }

  Mesh sphere_ = shapes::sphere(2);
};

TEST_F(WithCameras, EachViewHasItsOwn) {
  run(described("visible_from_direction: {front: [0, 0, 1], top: [0, 0.01, -2]}"));
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_TRUE(sees_side(truth(0), {0, 0, 1}));
  EXPECT_TRUE(sees_side(truth(1), {0, 0.01, -2}));
  EXPECT_FALSE(sees_side(truth(1), {0, 0, 1}));
  for (const ResultRow& row : toy_->results())
    EXPECT_EQ(row.scores.n_points, std::ranges::count_if(truth(row.view == "top" ? 1 : 0).saliency,
                                                         [](double value) { return !std::isnan(value); }));
}

TEST_F(WithCameras, APlaceIsInTheCoordinatesOfTheShape) {
  run(described("visible_from: [10, 0, 4]"));
  EXPECT_TRUE(sees_side(truth(0), {0, 0, 1}, 0.25)) << "the tangent plane's height is 1 / 4";
  EXPECT_EQ(sphere_.vertices.size(), truth(0).saliency.size());
  run(described("visible_from: [0, 0, 4]"));
  EXPECT_TRUE(sees_side(truth(0), {-10, 0, 4})) << "not around the origin";
}

TEST_F(WithCameras, AFileNamesThemByItemAndView) {
  data_.write("cameras.csv", "item,view,x,y,z\ncat,front,0,0,1\ndog,front,0,0,-1\ncat,top,1,0,0\n");
  run(described("visible_from_direction: cameras.csv"));
  EXPECT_TRUE(sees_side(truth(0), {0, 0, 1}));
  EXPECT_TRUE(sees_side(truth(1), {1, 0, 0}));
  data_.write("cameras.csv", "view,x,y,z\nfront,0,0,1\n");
  run(described("visible_from_direction: cameras.csv"));
  EXPECT_TRUE(sees_side(truth(0), {0, 0, 1}));
  EXPECT_THAT(failures(),
              ElementsAre(AllOf(HasSubstr("own.yaml:6: there is no camera of cat for the view 'top'"))));
}

TEST_F(WithCameras, ViewsThatAreAveragedAreHiddenOneByOne) {
  run(described("visible_from_direction: {front: [0, 0, 1], top: [0, 0, -1]}", "averaged"));
  EXPECT_THAT(failures(), IsEmpty());
  const GroundTruth both = truth();
  for (std::size_t i = 0; i < both.saliency.size(); ++i) {
    if (std::abs(sphere_.vertices[i].z()) > 0.3) {
      EXPECT_EQ(both.saliency[i], static_cast<double>(i % 7));
    }
  }
}

TEST_F(WithCameras, HideThePicksThatTheyDoNotSee) {
  std::size_t above = 0, below = 0;
  for (std::size_t i = 0; i < sphere_.vertices.size(); ++i) {
    if (sphere_.vertices[i].z() > sphere_.vertices[above].z()) above = i;
    if (sphere_.vertices[i].z() < sphere_.vertices[below].z()) below = i;
  }
  data_.write("clicks/cat_0.pid", fmt::format("{}\n{}\n", above, below));
  data_.write("clicks/cat_1.pid", fmt::format("{}\n", below));
  run(
      description("places: [{meshes: 'off/*', truth: {picks: 'clicks/{item}_{participant}.pid', "
                  "visible_from_direction: [0, 0, 1]}}]\n"));
  EXPECT_THAT(failures(), IsEmpty());
  EXPECT_TRUE(sees_side(truth(), {0, 0, 1}));
  EXPECT_THAT(truth().picks, ElementsAre(ElementsAre(static_cast<std::int32_t>(above)), IsEmpty()));
  EXPECT_TRUE(std::isnan(truth().saliency[below]));
  EXPECT_EQ(truth().saliency[above], 0.5) << "of two participants";
}

TEST_F(WithCameras, ArePartOfTheKeysOfWhatTheySee) {
  run(described("visible_from_direction: {front: [0, 0, 1], top: [1, 0, 0]}"));
  const Digest front = toy_->decision("ground_truth", 0).key, top = toy_->decision("ground_truth", 1).key;
  EXPECT_NE(front, top);
  run(described("visible_from_direction: {front: [0, 0, 1], top: [0, 1, 0]}"));
  EXPECT_EQ(toy_->decision("ground_truth", 0).key, front) << "another view's camera is no matter";
  EXPECT_NE(toy_->decision("ground_truth", 1).key, top);
  run(described("visible_from: {front: [0, 0, 1], top: [1, 0, 0]}"));
  EXPECT_NE(toy_->decision("ground_truth", 0).key, front) << "a place is no direction";
}

TEST_F(WithCameras, AreInspected) {
  const std::string own = described("visible_from_direction: [0, 0, 1]");
  const DataInspection found = inspect_data(data_.path(), layouts_of(own));
  ASSERT_EQ(found.items.size(), 2U);
  EXPECT_TRUE(found.items[0].of_camera);
  run(own);
  EXPECT_EQ(found.items[0].seen, static_cast<std::size_t>(std::ranges::count_if(
                                     truth().saliency, [](double value) { return !std::isnan(value); })));
  EXPECT_LT(found.items[0].seen, sphere_.vertices.size());
}

TEST_F(WithCameras, ThatSeeNothingFailTheirItem) {
  Mesh mesh{{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}, {-9, -9, 5}, {9, -9, 5}, {0, 9, 5}}, {{0, 1, 2}, {3, 4, 5}}};
  mesh.vertices.insert(mesh.vertices.end(), {{-9, -9, -5}, {9, -9, -5}, {0, 9, -5}});
  mesh.faces.push_back({6, 7, 8});
  data_.write("off/cat.off", off_text(mesh));
  for (const char* view : {"front", "top"})
    data_.write(fmt::format("maps/cat_{}.txt", view), "1\nnan\nnan\nnan\nnan\nnan\nnan\nnan\nnan\n");
  run(described("visible_from: {front: [0, 0, 1], top: [0, 0, 20]}\nvalues: {unseen: nan}"));
  EXPECT_THAT(failures(), ElementsAre(HasSubstr("maps/cat_top.txt: no point of the shape has a value")));
}

TEST_F(WithCameras, WrongDescriptionsAreNamedWithTheirLine) {
  const auto refused = [&](const std::string& cameras, const std::string& why) {
    EXPECT_THAT([&] { run(described(cameras)); },
                ThrowsMessage<ConfigError>(AllOf(HasSubstr("own.yaml:6"), HasSubstr(why))))
        << cameras;
  };
  refused("visible_from: [0, 1]", "is not three finite numbers");
  refused("visible_from: [0, 1, x]", "is not three finite numbers");
  refused("visible_from: [0, 1, .nan]", "is not three finite numbers");
  refused("visible_from: {front: 5}", "visible_from.front is not three finite numbers");
  refused("visible_from: {}", "names no view");
  refused("visible_from: [0, 1, 1e160]", "larger than 1e150");
  refused("visible_from_direction: [0, 0, 0]", "a direction has a length");
  refused("{visible_from: [0, 0, 1], visible_from_direction: [0, 0, 1]}", "");
}

TEST_F(WithCameras, WrongFilesAreNamedWithTheirLine) {
  const auto refused = [&](const std::string& text, const std::string& why) {
    data_.write("cameras.csv", text);
    EXPECT_THAT([&] { run(described("visible_from_direction: cameras.csv")); },
                ThrowsMessage<InputError>(StartsWith(place("cameras.csv") + why)))
        << text;
  };
  refused("x,y,z\n0,0,1\n", ":1: has neither a column 'item' nor 'view'");
  refused("view,x,y,z\nfront,0,0,1\ntop,0,0,0\n", ":3: a direction has a length");
  refused("view,x,y,z\nfront,0,0,\n", ":2: a coordinate is not a finite number");
  refused("view,x,y,z\nfront,0,0,1\nfront,0,0,1\n", ":3: " + place("cameras.csv") + ":2 has this camera");
}

}  // namespace
}  // namespace salbench
