// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/ground_truth/carried.h"

#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

constexpr double kUnseen = kNan;

// Two triangles over an edge, the second with twice the first's area, and a vertex in neither.
const Mesh kKite = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -2, 0}, {9, 9, 9}}, {{0, 1, 2}, {0, 3, 1}}};

TEST(ValuesOfFaces, AreWeighedByArea) {
  EXPECT_THAT(vertex_values_of_faces(kKite.vertices, kKite.faces, std::vector<double>{6, 3}),
              ElementsAre(4, 4, 6, 3, IsNan()));
}

TEST(ValuesOfFaces, AConstantStaysWhatItIs) {
  const Mesh mesh = shapes::bumpy_sphere(2);
  const ScalarField values(mesh.faces.size(), 0.3);
  EXPECT_THAT(vertex_values_of_faces(mesh.vertices, mesh.faces, values), Each(DoubleNear(0.3, 1e-15)));
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

TEST(ValuesOfFaces, WhatWasNotSeenIsNotZero) {
  EXPECT_THAT(vertex_values_of_faces(kKite.vertices, kKite.faces, std::vector<double>{6, kUnseen}),
              ElementsAre(6, 6, 6, IsNan(), IsNan()));
}

TEST(ValuesOfFaces, AFaceWithoutAreaSaysNothing) {
  const std::vector<Triangle> faces = {{0, 1, 2}, {0, 0, 3}};
  EXPECT_THAT(vertex_values_of_faces(kKite.vertices, faces, std::vector<double>{6, 100}),
              ElementsAre(6, 6, 6, IsNan(), IsNan()));
}

TEST(ValuesOfFaces, ThereIsOneForEachFace) {
  EXPECT_THROW(vertex_values_of_faces(kKite.vertices, kKite.faces, std::vector<double>{6}), InputError);
}

TEST(ValuesOfSamples, GoToTheNearestVerticesWithinReach) {
  const std::vector<Vec3> samples = {{0, 0, 0.1}, {0.9, 0, 0}, {0, 5, 0}};
  EXPECT_THAT(vertex_values_of_samples(kKite.vertices, samples, std::vector<double>{1, 2, 3}, 0.5),
              ElementsAre(1, 2, IsNan(), IsNan(), IsNan()));
  EXPECT_THAT(vertex_values_of_samples(kKite.vertices, samples, std::vector<double>{1, 2, 3}, 100),
              ElementsAre(1, 2, 1, 1, 3));
  EXPECT_THAT(vertex_values_of_samples(kKite.vertices, samples, std::vector<double>{kUnseen, 2, 3}, 0.5),
              ElementsAre(IsNan(), 2, IsNan(), IsNan(), IsNan()));
}

TEST(ValuesOfSamples, TheVerticesThemselvesKeepTheirValues) {
  const Mesh mesh = shapes::bumpy_sphere(2);
  ScalarField values;
  for (const Vec3& vertex : mesh.vertices) values.push_back(vertex.z());
  EXPECT_EQ(vertex_values_of_samples(mesh.vertices, mesh.vertices, values, 1e-9), values);
}

}  // namespace
}  // namespace salbench
