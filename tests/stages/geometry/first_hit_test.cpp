// SPDX-License-Identifier: GPL-3.0-or-later
// Rays are tested where they are used, in scans and in gaze.
#include "stages/geometry/first_hit.h"

#include "stages/core/rng.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

TEST(NearestPoint, AgreesWithALookAtEveryFace) {
  const Mesh mesh = shapes::bumpy_sphere(2);
  Mesh with_flat = mesh;
  with_flat.faces.insert(with_flat.faces.begin(), {0, 0, 1});
  const TracedMesh traced(with_flat);
  const auto distance = [&](const Vec3& place, const Triangle& face) {  // over many points of the face
    double least = kInfinity;
    constexpr int kSteps = 60;
    for (int i = 0; i <= kSteps; ++i)
      for (int j = 0; i + j <= kSteps; ++j) {
        const Vec3 w(i, j, kSteps - i - j);
        const Vec3 p = (w[0] * mesh.vertices[index(face[0])] + w[1] * mesh.vertices[index(face[1])] +
                        w[2] * mesh.vertices[index(face[2])]) /
                       kSteps;
        least = std::min(least, (p - place).norm());
      }
    return least;
  };
  Rng rng(3, "nearest", "toy");
  for (int k = 0; k < 20; ++k) {
    const Vec3 place = 2 * Vec3(rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5);
    const FirstHit hit = traced.nearest(place, 9);
    ASSERT_TRUE(hit);
    EXPECT_FALSE(traced.nearest(place, 0.999 * hit.depth));
    EXPECT_NEAR((hit.point_in(with_flat) - place).norm(), hit.depth, 1e-9);
    double least = kInfinity;
    for (const Triangle& face : mesh.faces) least = std::min(least, distance(place, face));
    EXPECT_LE(hit.depth, least + 1e-12);
    EXPECT_GT(hit.depth, least - 0.01);
  }
}

}  // namespace
}  // namespace salbench
