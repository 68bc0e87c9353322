// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/ground_truth/visible.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/core/errors.h"
#include "stages/geometry/mesh_ops.h"
#include "tests/support/shapes.h"

namespace salbench {
namespace {

using testing::Each;
using testing::ElementsAre;

Viewpoint direction(double x, double y, double z) { return {Vec3(x, y, z), true}; }

// True if a face that does not have the point as its corner lies between it and the viewpoint. [moeller1997]
bool is_hidden(const Mesh& mesh, std::size_t i, const Viewpoint& from) {
  const Vec3& origin = mesh.vertices[i];
  const Vec3 way = from.at_infinity ? from.place : Vec3(from.place - origin);
  for (const Triangle& face : mesh.faces) {
    if (std::ranges::count(face, static_cast<std::int32_t>(i)) > 0) continue;
    const Vec3& a = at(mesh.vertices, face[0]);
    const Vec3 ab = at(mesh.vertices, face[1]) - a, ac = at(mesh.vertices, face[2]) - a, to = origin - a;
    const Vec3 across = way.cross(ac), over = to.cross(ab);
    const double determinant = ab.dot(across);
    const double u = to.dot(across) / determinant, v = way.dot(over) / determinant,
                 t = ac.dot(over) / determinant;
    if (u >= 0 && v >= 0 && u + v <= 1 && t > 0 && (from.at_infinity || t < 1)) return true;
  }
  return false;
}

TEST(VisiblePoints, AreThoseOfATwinThatTriesEveryFace) {
  const Mesh mesh = shapes::bumpy_sphere(3);
  for (const Viewpoint& from : {direction(0.3, -0.8, 0.52), direction(-0.11, 0.07, -0.99),
                                Viewpoint{Vec3(1.7, 0.9, -0.4)}, Viewpoint{Vec3(0.05, 0.02, 0.01)}}) {
    const std::vector<bool> visible = visible_points(mesh.vertices, mesh.faces, from);
    std::size_t hidden = 0;
    for (std::size_t i = 0; i < visible.size(); ++i) {
      hidden += visible[i] ? 0U : 1U;
      EXPECT_EQ(visible[i], !is_hidden(mesh, i, from)) << i;
    }
    EXPECT_EQ(hidden > 0, from.at_infinity || from.place.norm() > 1)
        << "all of a hollow shape is seen from within";
  }
}

TEST(VisiblePoints, OfAnOpenSheetAreSeenFromBothSides) {
  const Mesh sheet = shapes::grid(4);
  for (const double side : {1.0, -1.0})
    EXPECT_THAT(visible_points(sheet.vertices, sheet.faces, direction(0.1, 0.2, side)), Each(true));
}

TEST(VisiblePoints, BehindASheetAreHiddenWhicheverWayItsFacesTurn) {
  Mesh mesh{{{-1, -1, 0}, {1, -1, 0}, {0, 2, 0}, {0, 0, -1}, {0, 0, 1}, {5, 5, -1}}, {{0, 1, 2}}};
  for (int turn = 0; turn < 2; ++turn) {
    EXPECT_THAT(visible_points(mesh.vertices, mesh.faces, {Vec3(0, 0, 4)}),
                ElementsAre(true, true, true, false, true, true));
    EXPECT_THAT(visible_points(mesh.vertices, mesh.faces, {Vec3(0, 0, 0.5)}),
                ElementsAre(true, true, true, false, true, true))
        << "nothing behind the camera hides a point";
    EXPECT_THAT(visible_points(mesh.vertices, mesh.faces, direction(0, 0, -1)),
                ElementsAre(true, true, true, true, false, true));
    std::swap(mesh.faces[0][0], mesh.faces[0][1]);
  }
}

TEST(VisiblePoints, DoNotDependOnPlaceAndUnit) {
  const Mesh mesh = shapes::bumpy_sphere(3);
  Mesh moved = mesh;
  const auto placed = [](const Vec3& point) { return Vec3(1000 * point + Vec3(300, -200, 5000)); };
  for (Vec3& v : moved.vertices) v = placed(v);
  const Vec3 camera(2, 1, 0.3);
  EXPECT_EQ(visible_points(mesh.vertices, mesh.faces, {camera}),
            visible_points(moved.vertices, moved.faces, {placed(camera)}));
}

TEST(VisiblePoints, WithoutFacesAreAll) {
  const Mesh sphere = shapes::sphere(1);
  EXPECT_THAT(visible_points(sphere.vertices, {}, direction(0, 0, 1)), Each(true));
  EXPECT_THROW(visible_points({}, {}, direction(0, 0, 1)), InputError);
  const std::vector<Triangle> wrong = {{0, 1, 99}};
  EXPECT_THROW(visible_points(sphere.vertices, wrong, direction(0, 0, 1)), InputError);
}

}  // namespace
}  // namespace salbench
