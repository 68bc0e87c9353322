// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/ground_truth/carried.h"

#include "tests/support/test.h"

namespace salbench {
namespace {

constexpr double kUnseen = kNan;

// Two triangles over an edge, the second with twice the first's area, and a vertex in neither.
const Mesh kKite = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -2, 0}, {9, 9, 9}}, {{0, 1, 2}, {0, 3, 1}}};

TEST(ValuesOfFaces, AreWeighedByAreaOfTheFacesThatWereSeen) {
  EXPECT_THAT(vertex_values_of_faces(kKite.vertices, kKite.faces, std::vector<double>{6, 3}),
              ElementsAre(4, 4, 6, 3, IsNan()));
  for (const Faces& faces : {kKite.faces, {{0, 1, 2}, {0, 0, 3}}})  // the second was not seen, or has no area
    EXPECT_THAT(vertex_values_of_faces(kKite.vertices, faces,
                                       std::vector<double>{6, faces == kKite.faces ? kUnseen : 100}),
                ElementsAre(6, 6, 6, IsNan(), IsNan()));
  EXPECT_THROW(vertex_values_of_faces(kKite.vertices, kKite.faces, std::vector<double>{6}), InputError);
}

TEST(ValuesOfFaces, AreOfAnySizeThatCanBeComputedWith) {
  Mesh large = kKite;
  for (Vec3& vertex : large.vertices) vertex *= 1e49;
  for (const Mesh& mesh : {kKite, large}) {
    const auto on_vertices = [&](double a, double b) {
      return vertex_values_of_faces(mesh.vertices, mesh.faces, std::vector<double>{a, b});
    };
    EXPECT_THAT(on_vertices(0x6p320, -0x6p320), ElementsAre(-0x2p320, -0x2p320, 0x6p320, -0x6p320, IsNan()));
    EXPECT_THAT(on_vertices(0x6p320, kUnseen), ElementsAre(0x6p320, 0x6p320, 0x6p320, IsNan(), IsNan()));
    EXPECT_THROW(on_vertices(1, 1e200), InputError);
  }
}

TEST(ValuesOfSamples, GoToTheNearestVerticesWithinReach) {
  const std::vector<Vec3> samples = {{0, 0, 0.1}, {0.9, 0, 0}, {0, 5, 0}};
  EXPECT_THAT(vertex_values_of_samples(kKite.vertices, samples, std::vector<double>{1, 2, 3}, 0.15),
              ElementsAre(1, 2, IsNan(), IsNan(), IsNan()));
  EXPECT_THAT(vertex_values_of_samples(kKite.vertices, samples, std::vector<double>{1, 2, 3}, 100),
              ElementsAre(1, 2, 1, 1, 3));
  EXPECT_THAT(vertex_values_of_samples(kKite.vertices, samples, std::vector<double>{kUnseen, 2, 3}, 0.15),
              ElementsAre(IsNan(), 2, IsNan(), IsNan(), IsNan()));
}

}  // namespace
}  // namespace salbench
