// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/core/rng.h"
#include "stages/ground_truth/carried.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

// Four vertices on a line at 0, 1, 2, 3; the camera's position is irrelevant.
Mesh line() { return {{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, {}}; }

GroundTruth truth_on_the_line() {
  GroundTruth truth;
  truth.saliency = {0.5, 0.25, 0, 1};
  truth.picks = {{3, 0}, {2}, {1, 3, 1}};
  return truth;
}

TEST(ScanGroundTruth, TakesTheNearestVertexAndTheFirstPointThatSeesAPick) {
  const Scan scan{
      {{1.1, 0, 0}, {2.9, 0, 0.2}, {0.8, 0.1, 0}, {3.0, 0, 0}, {0.1, 0, 0}}};  // none near vertex 2
  GroundTruth of_mesh = truth_on_the_line();
  EXPECT_FALSE(scan_ground_truth(scan, line(), of_mesh).simulated);
  of_mesh.simulated = true;
  const GroundTruth truth = scan_ground_truth(scan, line(), of_mesh);
  EXPECT_TRUE(truth.simulated);
  EXPECT_THAT(truth.saliency, ElementsAre(0.25, 1, 0.25, 1, 0.5));
  ASSERT_EQ(truth.picks.size(), 3U);
  EXPECT_THAT(truth.picks[0], ElementsAre(1, 4));  // 3 is first seen by point 1, although point 3 is nearer
  EXPECT_THAT(truth.picks[1], IsEmpty());          // hidden, but still a participant
  EXPECT_THAT(truth.picks[2], ElementsAre(0, 1));  // picked twice, kept once
}

TEST(ScanGroundTruth, OfAnEmptyScanHasParticipantsOnlyAndOfAnUnknownMeshIsUnknown) {
  const GroundTruth empty = scan_ground_truth({}, line(), truth_on_the_line()),
                    unknown = scan_ground_truth({{{0, 0, 0}}}, line(), {});
  EXPECT_THAT(empty.saliency, IsEmpty());
  EXPECT_THAT(empty.picks, ElementsAre(IsEmpty(), IsEmpty(), IsEmpty()));
  EXPECT_THAT(unknown.saliency, IsEmpty());
  EXPECT_THAT(unknown.picks, IsEmpty());
}

// Brute-force reference: every scan point against every vertex.
TEST(ScanGroundTruth, EqualsBruteForceOnAHalfSeenMesh) {
  const Mesh mesh = shapes::bumpy_sphere(3);
  Rng rng(4, "scan", "");
  Scan scan;
  for (int i = 0; i < 800; ++i) {
    const Vec3 direction(rng.normal(), rng.normal(), std::abs(rng.normal()));
    scan.points.push_back(direction.normalized() * (0.8 + 0.4 * rng.uniform()));
  }
  GroundTruth truth;
  truth.picks.resize(5);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) truth.saliency.push_back(rng.uniform());
  for (auto& own : truth.picks)
    for (int k = 0; k < 30; ++k) own.push_back(static_cast<std::int32_t>(rng.below(mesh.vertices.size())));

  const GroundTruth seen = scan_ground_truth(scan, mesh, truth);
  std::vector<std::int32_t> nearest;
  for (const Vec3& p : scan.points) {
    std::size_t best = 0;
    for (std::size_t v = 1; v < mesh.vertices.size(); ++v)
      if ((mesh.vertices[v] - p).squaredNorm() < (mesh.vertices[best] - p).squaredNorm()) best = v;
    nearest.push_back(static_cast<std::int32_t>(best));
  }
  for (std::size_t p = 0; p < nearest.size(); ++p)
    EXPECT_EQ(seen.saliency[p], truth.saliency[index(nearest[p])]) << "point " << p;
  std::size_t hidden = 0;
  for (std::size_t k = 0; k < truth.picks.size(); ++k) {
    std::set<std::int32_t> expected;
    for (const std::int32_t pick : truth.picks[k]) {
      const auto first = std::ranges::find(nearest, pick);
      if (first == nearest.end())
        ++hidden;
      else
        expected.insert(static_cast<std::int32_t>(first - nearest.begin()));
    }
    EXPECT_EQ(std::set(seen.picks[k].begin(), seen.picks[k].end()), expected);
    EXPECT_EQ(seen.picks[k].size(), expected.size()) << "each once";
  }
  EXPECT_GT(hidden, 30U);  // the lower half
}

TEST(ScanGroundTruth, RefusesTheTruthOfAnotherMesh) {
  const Scan scan{{{0, 0, 0}}};
  GroundTruth longer = truth_on_the_line(), beyond = longer, negative = longer;
  longer.saliency.push_back(1);
  beyond.picks[1].push_back(4);
  negative.picks[1].push_back(-1);
  EXPECT_THROW(scan_ground_truth(scan, line(), longer), InputError);
  EXPECT_THROW(scan_ground_truth(scan, line(), beyond), InputError);
  EXPECT_THROW(scan_ground_truth(scan, line(), negative), InputError);
  EXPECT_THROW(scan_ground_truth(scan, {}, {}), InputError);
}

}  // namespace
}  // namespace salbench
