// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/shapes/shape_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/shapes/mesh_file.h"
#include "io/table.h"
#include "tests/support/shapes.h"

namespace salbench {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

const std::vector<Vec3> kPoint = {{1, -2, 0.1}};

TEST(ShapeFile, OfOnePointAsCsv) {
  const std::vector<Vec3> normal = {{0, 0, 1}};
  EXPECT_EQ(shape_text({kPoint, normal, {}, {{"map_LS", {0.1}}}, "said"}, ShapeFormat::csv),
            "x,y,z,nx,ny,nz,map_LS,remarks\n1,-2,0.1,0,0,1,0.1,said\n");
  EXPECT_EQ(shape_text({kPoint}, ShapeFormat::csv), "x,y,z\n1,-2,0.1\n");
}

TEST(ShapeFile, CsvReadsBackToTheBit) {
  const Mesh mesh = shapes::bumpy_sphere(1);
  ScalarField field;
  for (const Vec3& v : mesh.vertices) field.push_back(v.x() / 3);
  const Table table = parse_csv(shape_text({mesh.vertices, {}, {}, {{"f", field}}}, ShapeFormat::csv), "x");
  EXPECT_EQ(number_column(table, "f"), field);
  EXPECT_EQ(number_column(table, "z").at(7), mesh.vertices[7].z());
}

TEST(ShapeFile, PlyIsTheMeshThatTheReaderReads) {
  const Mesh mesh = shapes::bumpy_sphere(2);
  const ScalarField field(mesh.vertices.size(), 0.5);
  const std::string bytes =
      shape_text({mesh.vertices, mesh.vertices, mesh.faces, {{"map_LS", field}}}, ShapeFormat::ply);
  EXPECT_THAT(bytes, HasSubstr("property float nz\nproperty float map_LS\nelement face"));
  const Mesh back = parse_ply(bytes, "x.ply");
  EXPECT_EQ(back.vertices, mesh.vertices);
  EXPECT_EQ(back.faces, mesh.faces);
}

TEST(ShapeFile, PlyOfPointsAloneHasNoFaces) {
  const std::string bytes = shape_text({.points = kPoint, .remark = "said"}, ShapeFormat::ply);
  EXPECT_THAT(bytes, StartsWith("ply\nformat binary_little_endian 1.0\ncomment said\nelement vertex 1\n"));
  EXPECT_THAT(bytes, Not(HasSubstr("element face")));
  EXPECT_EQ(bytes.size(), bytes.find("end_header\n") + 11 + 3 * sizeof(double));
}

// The block of a vertex cell's connectivity: UInt64 8, then Int64 0; of its offsets: 8, then 1.
TEST(ShapeFile, VtpOfAPointIsAVertexCell) {
  const std::string xml = shape_text({kPoint, {}, {}, {{"one", {0.0}}}, "said"}, ShapeFormat::vtp);
  EXPECT_THAT(xml, HasSubstr("<!-- said -->"));
  EXPECT_THAT(xml, HasSubstr("NumberOfPoints=\"1\" NumberOfVerts=\"1\""));
  EXPECT_THAT(xml, HasSubstr("Name=\"connectivity\" NumberOfComponents=\"1\" format=\"binary\">"
                             "CAAAAAAAAAAAAAAAAAAAAA==</DataArray>"));
  EXPECT_THAT(xml, HasSubstr("Name=\"offsets\" NumberOfComponents=\"1\" format=\"binary\">"
                             "CAAAAAAAAAABAAAAAAAAAA==</DataArray>"));
}

TEST(ShapeFile, FieldsMustFitThePoints) {
  EXPECT_THROW(shape_text({kPoint, {}, {}, {{"f", {1, 2}}}}, ShapeFormat::ply), std::logic_error);
}

}  // namespace
}  // namespace salbench
