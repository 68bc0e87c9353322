// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/vd.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/core/errors.h"
#include "tests/stages/models/surfaces.h"

namespace salbench {
namespace {

using testing::Each;
using testing::ElementsAre;

TEST(Vd, CountsEdges) {
  EXPECT_THAT(vd_saliency(shapes::tetrahedron().vertices, shapes::tetrahedron().faces, {}), Each(3));
  const Mesh torus = shapes::torus(2, 1, 9, 7);
  EXPECT_THAT(vd_saliency(torus.vertices, torus.faces, {}), Each(6));
}

// Twelve vertices of an icosahedron keep their five edges, whatever it is refined to.
TEST(Vd, OfASphereTellsItsMeshing) {
  const Mesh mesh = shapes::sphere(3);
  const ScalarField degree = vd_saliency(mesh.vertices, mesh.faces, {});
  EXPECT_EQ(std::ranges::count(degree, 5.0), 12);
  EXPECT_EQ(std::ranges::count(degree, 6.0), std::ssize(degree) - 12);
}

TEST(Vd, OfAnOpenFanAndAnIsolatedPoint) {
  const std::vector<Vec3> points(5, Vec3::Zero());  // no coordinate counts
  const Faces faces = {{0, 1, 2}, {0, 2, 3}};
  EXPECT_THAT(vd_saliency(points, faces, {}), ElementsAre(3, 2, 3, 2, 0));
  EXPECT_THAT(vd_saliency(points, {}, {}), Each(0));
}

TEST(VdDegenerate, AFaceWhosePointDoesNotExist) {
  const Faces faces = {{0, 1, 2}};
  EXPECT_THROW(vd_saliency(std::vector<Vec3>(2, Vec3::Zero()), faces, {}), InputError);
}

}  // namespace
}  // namespace salbench
