// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/SVD>

#include "stages/normals/normals.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

constexpr double kFewDegrees = 0.998;  // cosine of 3.6 degrees

MeshNormalsOptions pca(std::int32_t neighbours = MeshNormalsOptions{}.neighbours) {
  return {.method = MeshNormalsMethod::pca, .neighbours = neighbours};
}

double share_outward(const Normals& normals, const Normals& outward) {
  std::size_t good = 0;
  for (std::size_t i = 0; i < normals.size(); ++i) good += normals[i].dot(outward[i]) > 0;
  return static_cast<double>(good) / static_cast<double>(normals.size());
}

TEST(MeshNormals, OfASphereAreRadialAndOutward) {
  const Mesh mesh = shapes::sphere(4);
  for (const Normals& normals : {mesh_normals(mesh), mesh_normals(mesh, pca())})
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
      EXPECT_GT(normals.at(i).dot(mesh.vertices[i]), kFewDegrees) << i;
      EXPECT_NEAR(normals[i].norm(), 1, 1e-12);
    }
}

TEST(FaceNormals, AreWeightedByArea) {
  // Twice the area is 1 towards +z and 3 towards +x.
  const Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 3, 0}, {0, 0, 1}}, {{0, 1, 2}, {0, 3, 4}}};
  EXPECT_LT((mesh_normals(mesh)[0] - Vec3(3, 0, 1).normalized()).norm(), 1e-12);
}

TEST(FaceNormals, VertexWithoutAreaTakesItsNearestNeighbours) {
  Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 0, 0}, {5, 1, 0}, {5, 0, 1}}, {{0, 1, 2}, {3, 4, 5}}};
  mesh.vertices.emplace_back(0, 0, 1);  // in no face
  mesh.vertices.emplace_back(6, 0, 0);  // in a face without area
  mesh.faces.push_back({7, 7, 7});
  const Normals normals = mesh_normals(mesh);
  EXPECT_EQ(normals[6], Vec3::UnitZ());
  EXPECT_EQ(normals[7], Vec3::UnitX());
}

TEST(FaceNormals, FacesThatCancelTellNothing) {
  Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}};
  EXPECT_THROW(mesh_normals(mesh), InputError);
  mesh.vertices.insert(mesh.vertices.end(), {{3, 0, 0}, {3, 1, 0}, {3, 0, 1}});
  mesh.faces.push_back({3, 4, 5});
  EXPECT_EQ(mesh_normals(mesh)[0], Vec3::UnitX());
}

TEST(FaceNormals, RefuseMeshesWithoutOne) {
  EXPECT_THROW(mesh_normals({{{0, 0, 0}, {1, 0, 0}}, {}}), InputError);
  Mesh broken = shapes::tetrahedron();
  broken.vertices[1].z() = std::nan("");
  EXPECT_THROW(mesh_normals(broken), InputError);
}

TEST(PcaNormals, EqualTheSmallestSingularVectorOfBruteForceNeighbours) {
  const std::vector<Vec3> points = shapes::random_cloud(150, 4);
  const Normals normals = mesh_normals({points, {}}, pca(12));
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::vector<Vec3> near = points;
    std::ranges::sort(near, [&](const Vec3& a, const Vec3& b) {
      return (a - points[i]).squaredNorm() < (b - points[i]).squaredNorm();
    });
    near.resize(12);
    Eigen::Matrix<double, 12, 3> rows;
    for (Eigen::Index k = 0; k < 12; ++k) rows.row(k) = near[static_cast<std::size_t>(k)];
    rows.rowwise() -= rows.colwise().mean().eval();
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(rows, Eigen::ComputeThinV);
    EXPECT_GT(std::abs(normals[i].dot(svd.matrixV().col(2))), 1 - 1e-9) << i;
  }
}

TEST(PcaNormals, SeparateBodiesAllFaceOutward) {
  // Chains of distant bodies: no tree connects them.
  const Mesh body = shapes::bumpy_sphere(3);
  const Normals outward = mesh_normals(body);
  Mesh mesh;
  Normals expected;
  for (const Vec3& shift : {Vec3(0, 0, 0), Vec3(9, 0, 0), Vec3(0, -9, 0), Vec3(4, 4, 20)}) {
    for (const Vec3& v : body.vertices) mesh.vertices.push_back(v + shift);
    expected.insert(expected.end(), outward.begin(), outward.end());
  }
  EXPECT_EQ(share_outward(mesh_normals(mesh, pca()), expected), 1);
}

TEST(PcaNormals, AutomaticNeighboursAreThoseOfTheGrownSupport) {
  const Mesh mesh = shapes::bumpy_sphere(3);  // six neighbours on average within the grown radius
  EXPECT_EQ(mesh_normals(mesh, pca()), mesh_normals(mesh, pca(6)));
  EXPECT_NE(mesh_normals(mesh, pca()), mesh_normals(mesh, pca(9)));
  MeshNormalsOptions wide = pca();
  wide.support = 1;  // contains far more than the limit
  EXPECT_EQ(mesh_normals(mesh, wide), mesh_normals(mesh, pca(30)));
}

TEST(PcaNormals, DegenerateShapesGetUnitNormals) {
  const std::vector<std::vector<Vec3>> shapes = {
      {{1, 2, 3}},                                   // one point
      {{0, 0, 0}, {0, 0, 2}},                        // two
      std::vector<Vec3>(40, Vec3(5, 5, 5)),          // all in one place
      {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}},  // on a line
  };
  for (const auto& points : shapes) {
    const Normals normals = mesh_normals({points, {}}, pca());
    ASSERT_EQ(normals.size(), points.size());
    for (const Vec3& n : normals) EXPECT_NEAR(n.norm(), 1, 1e-12);
  }
  EXPECT_LT(std::abs(mesh_normals({shapes[3], {}}, pca())[1].dot(Vec3(1, 1, 1))), 1e-6);
  EXPECT_THAT([] { mesh_normals({}, pca()); }, Refuses("no vertices"));
}

}  // namespace
}  // namespace salbench
