// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/floors.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

ScalarField random_saliency(const std::vector<Vec3>& points, std::uint64_t seed, const std::string& item) {
  return rs_saliency(points, {seed, item}, {});
}

TEST(RsSaliency, IsUniformOverTheUnitInterval) {
  ScalarField values = random_saliency(shapes::random_cloud(20000, 1), 1, "9");
  std::ranges::sort(values);
  double largest_gap = 0;  // Kolmogorov-Smirnov: 1.63 / sqrt(n) is exceeded once in a hundred seeds
  for (std::size_t i = 0; i < values.size(); ++i)
    largest_gap = std::max(largest_gap, std::abs(values[i] - static_cast<double>(i) / 20000));
  EXPECT_LT(largest_gap, 1.63 / std::sqrt(20000.0));
  EXPECT_GE(values.front(), 0);
  EXPECT_LT(values.back(), 1);
}

TEST(RsSaliency, DependsOnSeedAndItemAlone) {
  const auto points = shapes::random_cloud(50, 1), others = shapes::random_cloud(50, 2);
  EXPECT_EQ(random_saliency(points, 1, "9"), random_saliency(others, 1, "9"));
  EXPECT_NE(random_saliency(points, 1, "9"), random_saliency(points, 2, "9"));
  EXPECT_NE(random_saliency(points, 1, "9"), random_saliency(points, 1, "9_0"));
}

}  // namespace
}  // namespace salbench
