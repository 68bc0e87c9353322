// LS against what the benchmark's authors published of it, with the normals and descriptors of the
// `published` protocol.
#include <cmath>

#include <gtest/gtest.h>

#include "io/mesh_file.h"
#include "stages/core/field.h"
#include "stages/fpfh/fpfh.h"
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
  ModelInput input;
  input.points = mesh.vertices;
  input.normals = normals;
  input.fpfh = &descriptors;
  return ls_saliency(input, LsOptions{});
}

TEST(LsPublished, ScoresAreThoseOfTheAuthors) {
  const auto data = real_data();
  if (!data) GTEST_SKIP() << kNoRealData;
  const Histogram histogram = published::reference_histogram(*data);
  double nss_error = 0, cc_error = 0;
  int compared = 0;
  for (const int item : published::kMeshes) {
    const Scores expected = published::scores(*data, item, "LS");
    if (std::isnan(expected.nss)) continue;  // LS is published for twelve of them
    const GroundTruth truth = published::ground_truth(*data, item);
    const ScalarField map = matched(ls_of_mesh(*data, item), histogram);
    const double nss_off = std::abs(nss(map, picked_points(truth)) - expected.nss);
    const double cc_off = std::abs(cc(map, min_max_normalized(truth.saliency)) - expected.cc);
    EXPECT_LE(nss_off, 0.01) << "mesh " << item;
    EXPECT_LE(cc_off, 0.01) << "mesh " << item;
    nss_error += nss_off;
    cc_error += cc_off;
    ++compared;
  }
  ASSERT_EQ(compared, 12);
  RecordProperty("mean_nss_error", std::to_string(nss_error / compared));
  RecordProperty("mean_cc_error", std::to_string(cc_error / compared));
  EXPECT_LE(nss_error / compared, 0.002);
  EXPECT_LE(cc_error / compared, 0.002);
}

TEST(LsPublished, MapsAreThoseOfThePapersFigures) {
  const auto data = real_data();
  if (!data) GTEST_SKIP() << kNoRealData;
  const std::pair<int, double> least_correlation[] = {{2, 0.995}, {65, 0.99}, {336, 0.995}};
  for (const auto& [item, least] : least_correlation) {
    const auto figure =
        published::numbers(*data / "reference" / "figures" / ("LS_" + std::to_string(item) + ".txt"));
    const ScalarField saliency = ls_of_mesh(*data, item);
    ScalarField ours, theirs;  // at the vertices that the figure shows
    for (std::size_t i = 0; i + 1 < figure.size(); i += 2) {
      ours.push_back(saliency.at(static_cast<std::size_t>(figure[i])));
      theirs.push_back(figure[i + 1]);
    }
    const double correlation = cc(ours, theirs);
    RecordProperty("correlation_" + std::to_string(item), std::to_string(correlation));
    EXPECT_GE(correlation, least) << "mesh " << item;
  }
}

}  // namespace
}  // namespace salbench
