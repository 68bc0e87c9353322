// SPDX-License-Identifier: GPL-3.0-or-later
// The authors' own maps must have the scores that the authors published for them.
#include "tests/stages/metrics/published.h"

#include "stages/matching/matching.h"
#include "stages/metrics/score.h"
#include "tests/support/data.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

TEST(PublishedScores, FollowFromThePublishedMaps) {
  const auto data = real_data();
  if (!data) GTEST_SKIP() << kNoRealData;
  const Histogram reference = published::reference_histogram(*data);
  for (const int mesh : published::kMeshes) {
    const std::string name = std::to_string(mesh);
    const ScalarField map = published::numbers(*data / "reference" / "CS" / (name + ".val"));
    const Scores actual =
        score(matched(map, reference), published::ground_truth(*data, mesh), {}, Rng(1, "CS", name));
    const published::PublishedScores expected = published::scores(*data, mesh, "CS");
    EXPECT_NEAR(value_of(actual, "nss"), expected.nss, 1e-4) << "mesh " << mesh;
    EXPECT_NEAR(value_of(actual, "cc"), expected.cc, 1e-4) << "mesh " << mesh;
    EXPECT_NEAR(value_of(actual, "auc"), expected.auc, 0.005) << "mesh " << mesh;
  }
}

}  // namespace
}  // namespace salbench
