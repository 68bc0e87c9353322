// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/shapes/shape_file.h"

#include "io/shapes/mesh_file.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

const std::vector<Vec3> kPoint = {{1, -2, 0.1}};

TEST(ShapeFile, PlyIsTheMeshThatTheReaderReads) {
  const Mesh mesh = shapes::bumpy_sphere(2);
  const ScalarField field(mesh.vertices.size(), 0.5);
  const std::string bytes = ply_of({mesh.vertices, mesh.vertices, mesh.faces, {{"map_LS", field}}});
  EXPECT_THAT(bytes, HasSubstr("property float nz\nproperty float map_LS\nelement face"));
  const Mesh back = parse_ply(bytes, "x.ply");
  EXPECT_EQ(back.vertices, mesh.vertices);
  EXPECT_EQ(back.faces, mesh.faces);
}

TEST(ShapeFile, PlyOfPointsAloneHasNoFaces) {
  const std::string bytes = ply_of({.points = kPoint, .remark = "said"});
  EXPECT_THAT(bytes, StartsWith("ply\nformat binary_little_endian 1.0\ncomment said\nelement vertex 1\n"));
  EXPECT_THAT(bytes, Not(HasSubstr("element face")));
  EXPECT_EQ(bytes.size(), bytes.find("end_header\n") + 11 + 3 * sizeof(double));
}

TEST(ShapeFile, FieldsMustFitThePoints) {
  EXPECT_THROW(ply_of({kPoint, {}, {}, {{"f", {1, 2}}}}), std::logic_error);
}

}  // namespace
}  // namespace salbench
