// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/geometry/kd_nodes.h"

#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

using testing::ElementsAreArray;

std::vector<std::int32_t> every(std::int32_t step, std::size_t n) {
  std::vector<std::int32_t> indices;
  for (std::int32_t i = 0; index(i) < n; i += step) indices.push_back(i);
  return indices;
}

// 4 x 4 x 3 points: every cut leaves points on its plane.
std::vector<Vec3> scrambled_lattice() {
  std::vector<Vec3> lattice;
  for (int i = 0; i < 48; ++i) {
    const int place = 7 * i % 48;
    lattice.emplace_back(place % 4, place / 4 % 4, place / 16);
  }
  return lattice;
}

// Checks a node and its descendants, and returns their number.
std::size_t check_node(const KdNodes& tree, const std::vector<Vec3>& points, const KdNode& node) {
  EXPECT_LT(node.first, node.last);
  if (node.is_leaf()) {
    EXPECT_LE(node.last - node.first, kLeaf);
    return 1;
  }
  const KdNode &near = node.near_child(), &far = node.far_child();
  EXPECT_EQ(near.first, node.first);
  EXPECT_EQ(near.last, far.first);
  EXPECT_EQ(far.last, node.last);
  const auto coordinate = [&](std::size_t place) { return points[index(tree.order[place])][node.axis]; };
  double low = coordinate(near.first), high = coordinate(far.first);
  for (std::size_t place = near.first; place < near.last; ++place) low = std::max(low, coordinate(place));
  for (std::size_t place = far.first; place < far.last; ++place) high = std::min(high, coordinate(place));
  EXPECT_EQ(node.low, low);
  EXPECT_EQ(node.high, high);
  EXPECT_LE(low, high);
  return 1 + check_node(tree, points, near) + check_node(tree, points, far);
}

TEST(KdNodes, EveryPointLiesInOneLeafOnItsSideOfEachGap) {
  const std::vector<std::vector<Vec3>> clouds = {shapes::random_cloud(1000, 3), scrambled_lattice(),
                                                 std::vector<Vec3>(100, Vec3(1, 2, 3)),
                                                 shapes::random_cloud(12, 4), shapes::random_cloud(13, 5)};
  for (const std::vector<Vec3>& points : clouds)
    for (const std::vector<std::int32_t>& members : {every(1, points.size()), every(2, points.size())}) {
      const KdNodes tree = kd_nodes(points, members);
      std::vector<std::int32_t> order = tree.order;
      std::ranges::sort(order);
      EXPECT_EQ(order, members);
      EXPECT_EQ(check_node(tree, points, tree.nodes.front()), tree.nodes.size());
      for (const std::int32_t i : members)
        for (Eigen::Index axis = 0; axis < 3; ++axis) {
          EXPECT_LE(tree.low[axis], points[index(i)][axis]);
          EXPECT_GE(tree.high[axis], points[index(i)][axis]);
        }
    }
  EXPECT_TRUE(kd_nodes({}, {}).nodes.empty());
}

// From nanoflann 1.4.3: even samples, and so the maps of large shapes, depend on it.
TEST(KdNodes, TheOrderIsThatOfEarlierResults) {
  EXPECT_THAT(kd_nodes(scrambled_lattice(), every(1, 48)).order,
              ElementsAreArray({0,  23, 44, 3,  19, 28, 16, 7,  32, 39, 35, 12, 11, 36, 8,  15,
                                40, 31, 43, 4,  20, 27, 24, 47, 1,  46, 26, 21, 5,  42, 30, 17,
                                14, 33, 37, 10, 13, 34, 38, 9,  6,  41, 29, 18, 2,  45, 25, 22}));
}

}  // namespace
}  // namespace salbench
