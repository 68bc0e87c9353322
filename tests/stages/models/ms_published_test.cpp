// SPDX-License-Identifier: GPL-3.0-or-later
// MS against what the benchmark's authors published of it. Their program is not known: the agreement is
// close, not exact.
#include <cmath>

#include <gtest/gtest.h>

#include "io/shapes/mesh_file.h"
#include "stages/core/field.h"
#include "stages/matching/matching.h"
#include "stages/metrics/metrics.h"
#include "stages/models/ms.h"
#include "tests/stages/metrics/published.h"
#include "tests/support/data.h"

namespace salbench {
namespace {

ScalarField ms_of_mesh(const published::path& data, int item) {
  const Mesh mesh = read_mesh(data / "SchellingData" / "Meshes" / (std::to_string(item) + ".off"));
  return ms_saliency(mesh.vertices, mesh.faces, MsOptions{});
}

TEST(MsPublished, ScoresAreNearThoseOfTheAuthors) {
  const auto data = real_data();
  if (!data) GTEST_SKIP() << kNoRealData;
  const published::MeanErrors errors = published::mean_errors(*data, "MS", ms_of_mesh);
  EXPECT_EQ(errors.meshes, 12);
  EXPECT_LE(errors.nss, 0.04);
  EXPECT_LE(errors.cc, 0.04);
}

TEST(MsPublished, MapsAreNearThoseOfThePapersFigures) {
  const auto data = real_data();
  if (!data) GTEST_SKIP() << kNoRealData;
  const std::pair<int, double> least_correlation[] = {{2, 0.97}, {65, 0.955}};
  for (const auto& [mesh, least] : least_correlation)
    EXPECT_GE(published::correlation_with_figure(*data, "MS", mesh, ms_of_mesh(*data, mesh)), least) << mesh;
}

TEST(MsPublished, EveryMeshHasAMap) {
  const auto data = real_data();
  if (!data) GTEST_SKIP() << kNoRealData;
  for (int item = 2; item <= 400; item += 20) {  // one of each class
    if (item == 262) continue;                   // not in the distribution
    EXPECT_FALSE(is_constant(ms_of_mesh(*data, item))) << "mesh " << item;
  }
}

}  // namespace
}  // namespace salbench
