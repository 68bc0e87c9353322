// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/shapes/mesh_file.h"
#include "stages/scan/scan.h"
#include "tests/support/data.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

TEST(ScansOfRealMeshes, HaveTheSizeOfThePublishedOnes) {
  const auto data = real_data();
  if (!data) GTEST_SKIP() << kNoRealData;
  double total = 0;
  int scans = 0;
  for (int number = 10; number <= 400; number += 40) {
    if (number > 260 && number <= 280) continue;  // missing in the published set
    const Mesh mesh = read_mesh(*data / "SchellingData" / "Meshes" / (std::to_string(number) + ".off"));
    for (int view = 0; view < kViews; ++view, ++scans) {
      const auto count = static_cast<double>(simulate_scan(mesh, view).points.size());
      EXPECT_GT(count, 1000) << number << "_" << view;
      EXPECT_LT(count, 9500) << number << "_" << view;
      total += count;
    }
  }
  EXPECT_NEAR(total / scans, 5500, 500);
}

}  // namespace
}  // namespace salbench
