// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/geometry/faces.h"

#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

// Two right triangles that share the edge 1-2, and a third one at their corner 3.
const std::vector<Vec3> kPoints = {{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {3, 3, 0}, {6, 3, 0}, {3, 9, 0}};
const Faces kFaces = {{0, 1, 2}, {1, 3, 2}, {3, 4, 5}};

TEST(Faces, HaveAreasAndCentroids) {
  EXPECT_THAT(face_areas(kPoints, kFaces), ElementsAre(4.5, 4.5, 9));
  EXPECT_THAT(face_centroids(kPoints, kFaces), ElementsAre(Vec3(1, 1, 0), Vec3(2, 2, 0), Vec3(4, 5, 0)));
}

TEST(Faces, AreNextToThoseAcrossAnEdge) {
  const Adjacency adjacency = face_adjacency(kPoints.size(), kFaces);
  EXPECT_THAT(adjacency.of(0), ElementsAre(1));
  EXPECT_THAT(adjacency.of(1), ElementsAre(0));
  EXPECT_THAT(adjacency.of(2), IsEmpty()) << "a corner joins nothing";
  const Mesh sphere = shapes::sphere(2);
  const Adjacency closed = face_adjacency(sphere.vertices.size(), sphere.faces);
  for (std::size_t i = 0; i < closed.size(); ++i) EXPECT_THAT(closed.of(i), SizeIs(3));
}

TEST(Faces, DoNotMeetAcrossAnEdgeOfThree) {
  const Adjacency adjacency = face_adjacency(6, Faces{{0, 1, 2}, {0, 1, 3}, {1, 0, 4}, {1, 2, 5}});
  EXPECT_THAT(adjacency.of(0), ElementsAre(3));
  EXPECT_THAT(adjacency.of(1), IsEmpty());
}

TEST(Faces, HaveTheMeansOfTheirCorners) {
  EXPECT_THAT(values_by_face(ScalarField{0, 3, 6, 9, 0, kNan}, kPoints.size(), kFaces),
              Pointwise(DoubleNear(1e-15), {3.0, 6.0, 3.0}));
  EXPECT_NEAR(values_by_face(ScalarField(6, 1e308), 6, kFaces)[0], 1e308, 1e293) << "no sum overflows";
}

TEST(Faces, KeepValuesOfTheirOwn) {
  const ScalarField own = {1, kNan, 3};
  EXPECT_THAT(values_by_face(own, kPoints.size(), kFaces), Pointwise(testing::NanSensitiveDoubleEq(), own));
  EXPECT_THAT(values_by_face(ScalarField{1, 1, 4}, 3, Faces{{0, 1, 2}, {0, 1, 2}, {0, 2, 1}}),
              Pointwise(DoubleNear(1e-15), {2.0, 2.0, 2.0}))
      << "as many points as faces: a value per point";
  EXPECT_THROW(values_by_face(ScalarField(4), kPoints.size(), kFaces), InputError);
}

}  // namespace
}  // namespace salbench
