// SPDX-License-Identifier: GPL-3.0-or-later
// LS against what the benchmark's authors published of it, with the normals and descriptors of the
// `published` protocol.
#include <cmath>

#include <gtest/gtest.h>

#include "io/shapes/mesh_file.h"
#include "stages/core/field.h"
#include "stages/descriptors/fpfh.h"
#include "stages/matching/matching.h"
#include "stages/metrics/metrics.h"
#include "stages/models/ls.h"
#include "stages/normals/normals.h"
#include "tests/stages/metrics/published.h"
#include "tests/support/data.h"

namespace salbench {
namespace {

ScalarField ls_of_mesh(const published::path& data, int item) {
  const Mesh mesh = read_mesh(data / "SchellingData" / "Meshes" / (std::to_string(item) + ".off"));
  const Normals normals = mesh_normals(mesh);
  const Descriptors descriptors = fpfh(mesh.vertices, normals, FpfhOptions{});
  return ls_saliency(mesh.vertices, normals, descriptors, LsOptions{});
}

TEST(LsPublished, ScoresAreThoseOfTheAuthors) {
  const auto data = real_data();
  if (!data) GTEST_SKIP() << kNoRealData;
  const published::MeanErrors errors = published::mean_errors(*data, "LS", ls_of_mesh);
  EXPECT_EQ(errors.meshes, 12);
  EXPECT_LE(errors.nss, 0.002);
  EXPECT_LE(errors.cc, 0.002);
}

TEST(LsPublished, MapsAreThoseOfThePapersFigures) {
  const auto data = real_data();
  if (!data) GTEST_SKIP() << kNoRealData;
  const std::pair<int, double> least_correlation[] = {{2, 0.995}, {65, 0.99}, {336, 0.995}};
  for (const auto& [mesh, least] : least_correlation)
    EXPECT_GE(published::correlation_with_figure(*data, "LS", mesh, ls_of_mesh(*data, mesh)), least) << mesh;
}

}  // namespace
}  // namespace salbench
