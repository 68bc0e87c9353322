// MS against what the benchmark's authors published of it. Their program is not known: the agreement is
// close, not exact.
#include <cmath>

#include <gtest/gtest.h>

#include "io/mesh_file.h"
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
  ModelInput input;
  input.points = mesh.vertices;
  input.faces = mesh.faces;
  return ms_saliency(input, MsOptions{});
}

TEST(MsPublished, ScoresAreNearThoseOfTheAuthors) {
  const auto data = real_data();
  if (!data) GTEST_SKIP() << kNoRealData;
  const Histogram histogram = published::reference_histogram(*data);
  double nss_error = 0, cc_error = 0;
  int compared = 0;
  for (const int item : published::kMeshes) {
    const Scores expected = published::scores(*data, item, "MS");
    if (std::isnan(expected.nss)) continue;  // MS is published for twelve of them
    const GroundTruth truth = published::ground_truth(*data, item);
    const ScalarField map = matched(ms_of_mesh(*data, item), histogram);
    nss_error += std::abs(nss(map, picked_points(truth)) - expected.nss);
    cc_error += std::abs(cc(map, min_max_normalized(truth.saliency)) - expected.cc);
    ++compared;
  }
  ASSERT_EQ(compared, 12);
  RecordProperty("mean_nss_error", std::to_string(nss_error / compared));
  RecordProperty("mean_cc_error", std::to_string(cc_error / compared));
  EXPECT_LE(nss_error / compared, 0.04);
  EXPECT_LE(cc_error / compared, 0.04);
}

TEST(MsPublished, MapsAreNearThoseOfThePapersFigures) {
  const auto data = real_data();
  if (!data) GTEST_SKIP() << kNoRealData;
  const std::pair<int, double> least_correlation[] = {{2, 0.97}, {65, 0.955}};
  for (const auto& [item, least] : least_correlation) {
    const auto figure =
        published::numbers(*data / "reference" / "figures" / ("MS_" + std::to_string(item) + ".txt"));
    const ScalarField saliency = ms_of_mesh(*data, item);
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
