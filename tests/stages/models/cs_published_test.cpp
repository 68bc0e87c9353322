// SPDX-License-Identifier: GPL-3.0-or-later
// CS against the maps that the benchmark's authors published of it.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

#include <gtest/gtest.h>

#include "io/shapes/mesh_file.h"
#include "stages/models/cs.h"
#include "stages/normals/normals.h"
#include "tests/stages/metrics/published.h"
#include "tests/support/correlation.h"
#include "tests/support/data.h"

namespace salbench {
namespace {

ScalarField cs_of_mesh(const std::filesystem::path& file) {
  const Mesh mesh = read_mesh(file);
  return cs_saliency(mesh.vertices, mesh_normals(mesh), CsOptions{});
}

// Linear between the order statistics, as NumPy has it.
double quantile(const std::vector<double>& sorted, double q) {
  const double position = q * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], position - static_cast<double>(below));
}

TEST(CsPublished, MapsAreThoseOfTheAuthors) {
  const auto data = real_data();
  if (!data) GTEST_SKIP() << kNoRealData;
  std::vector<double> agreement;
  std::ostringstream by_mesh;
  for (const auto& entry : std::filesystem::directory_iterator(*data / "reference" / "CS")) {
    const std::string item = entry.path().stem().string();
    const ScalarField map = cs_of_mesh(*data / "SchellingData" / "Meshes" / (item + ".off"));
    agreement.push_back(spearman(map, published::numbers(entry.path())));
    by_mesh << item << " " << agreement.back() << "\n";
  }
  ASSERT_EQ(agreement.size(), 92U);
  std::ranges::sort(agreement);
  const double median = quantile(agreement, 0.5), tenth = quantile(agreement, 0.1);
  EXPECT_GE(median, 0.99) << by_mesh.str();
  EXPECT_GE(tenth, 0.95) << by_mesh.str();
  RecordProperty("spearman_median", std::to_string(median));
  RecordProperty("spearman_10th_percentile", std::to_string(tenth));
  RecordProperty("spearman_least", std::to_string(agreement.front()));
}

}  // namespace
}  // namespace salbench
