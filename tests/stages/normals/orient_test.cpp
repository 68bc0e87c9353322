// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/normals/orient.h"

#include "tests/support/shapes.h"
#include "tests/support/test.h"
#include "tests/support/threads.h"

namespace salbench {
namespace {

Normals randomly_flipped(Normals normals) {
  Rng rng(5, "flip", "");
  for (Vec3& n : normals)
    if (rng.below(2) == 0) n = -n;
  return normals;
}

// Turns the first point of each component towards +z; records the sizes of the components.
struct FirstUp {
  std::vector<std::size_t> sizes;
  OrientationSeed operator()(std::span<const std::int32_t> component) {
    sizes.push_back(component.size());
    return {component.front(), Vec3::UnitZ()};
  }
};

TEST(OrientNormals, UndoesRandomFlipsOnASphere) {
  const std::vector<Vec3> points = shapes::sphere(4).vertices;  // their own normals
  Normals normals = randomly_flipped(points);
  std::size_t asked = 0;
  const auto top = [&](std::span<const std::int32_t> component) -> OrientationSeed {
    ++asked;
    EXPECT_EQ(component.size(), points.size());
    EXPECT_TRUE(std::ranges::is_sorted(component));
    return {17, points[17]};
  };
  orient_normals(points, KdTree(points).nearest_of_each(points, 7), {6}, top, normals);
  EXPECT_EQ(normals, points);
  EXPECT_EQ(asked, 1U);
}

TEST(OrientNormals, FollowsAFoldThatNoSingleDirectionCouldOrient) {
  // A spiral strip: its normals make three full turns.
  std::vector<Vec3> points;
  Normals outward;
  for (int step = 0; step < 600; ++step) {
    const double angle = step * std::numbers::pi / 100;
    for (int row = 0; row < 5; ++row) {
      points.emplace_back((4 + angle) * std::cos(angle), (4 + angle) * std::sin(angle), 0.15 * row);
      const Vec3 along(std::cos(angle) - (4 + angle) * std::sin(angle),
                       std::sin(angle) + (4 + angle) * std::cos(angle), 0);
      outward.push_back(along.cross(Vec3::UnitZ()).normalized());
    }
  }
  Normals normals = randomly_flipped(outward);
  const auto start = [&](std::span<const std::int32_t>) -> OrientationSeed { return {0, outward[0]}; };
  orient_normals(points, KdTree(points).nearest_of_each(points, 7), {6}, start, normals);
  EXPECT_EQ(normals, outward);
}

TEST(OrientNormals, EdgesBeyondTheLongestSeparate) {
  std::vector<Vec3> points = shapes::grid(9).vertices;
  for (std::size_t i = 50; i < 100; ++i) points[i].y() += 0.2;  // a gap of three spacings
  FirstUp rule;
  Normals normals = randomly_flipped(Normals(points.size(), Vec3::UnitZ()));
  orient_normals(points, KdTree(points).nearest_of_each(points, 61), {60, 0.25}, std::ref(rule), normals);
  EXPECT_THAT(rule.sizes, ElementsAre(50U, 50U));
  EXPECT_EQ(normals, Normals(points.size(), Vec3::UnitZ()));

  FirstUp unlimited;
  orient_normals(points, KdTree(points).nearest_of_each(points, 61), {60}, std::ref(unlimited), normals);
  EXPECT_THAT(unlimited.sizes, ElementsAre(100U));
}

TEST(OrientNormals, TurnsBeyondTheLargestSeparate) {
  // Two strips that meet at a right angle, distinguished by their normals only.
  const std::vector<Vec3> points = shapes::grid(9).vertices;
  Normals folded(50, Vec3(0.6, 0, 0.8));
  folded.insert(folded.end(), 50, Vec3(-0.8, 0, 0.6));
  FirstUp rule;
  Normals normals = randomly_flipped(folded);
  orient_normals(points, KdTree(points).nearest_of_each(points, 9), {8, 10, std::numbers::pi / 4},
                 std::ref(rule), normals);
  EXPECT_THAT(rule.sizes, ElementsAre(50U, 50U));
  EXPECT_EQ(normals, folded);
}

TEST(OrientNormals, ReachesEveryPointAlsoAcrossRightAnglesAndCoincidentPoints) {
  // Nine points in each place: nearest neighbours are all at distance 0, and the choice is arbitrary.
  std::vector<Vec3> points;
  Normals upright;
  for (int i = 0; i < 20; ++i) {
    points.insert(points.end(), 9, Vec3(i, 0, 0));
    upright.insert(upright.end(), 9, (i < 10 ? Vec3(0, 0.6, 0.8) : Vec3(0, -0.8, 0.6)));
  }
  Normals normals = randomly_flipped(upright);
  orient_normals(points, KdTree(points).nearest_of_each(points, 7), {6}, FirstUp(), normals);
  EXPECT_EQ(normals, upright);
}

TEST(OrientNormals, SinglePointsAndNone) {
  std::vector<Vec3> points;
  Normals normals;
  orient_normals(points, KdTree(points).nearest_of_each(points, 7), {6}, FirstUp(), normals);
  EXPECT_TRUE(normals.empty());
  points = {{1, 1, 1}};
  normals = {{0, 0, -1}};
  orient_normals(points, KdTree(points).nearest_of_each(points, 7), {6}, FirstUp(), normals);
  EXPECT_EQ(normals[0], Vec3::UnitZ());
}

TEST(OrientNormals, DoesNotDependOnOtherThreads) {
  const std::vector<Vec3> points = shapes::random_cloud(3000, 8);
  const Normals start = shapes::random_normals(3000, 9);
  const NearestPoints near = KdTree(points).nearest_of_each(points, 7);
  const Normals found = same_in_threads_at_once([&] {
    Normals normals = start;
    orient_normals(points, near, {6}, FirstUp(), normals);
    return normals;
  });
  EXPECT_NE(found, start);
}

}  // namespace
}  // namespace salbench
