// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/curvature.h"

#include <Eigen/Eigenvalues>

#include "tests/stages/models/surfaces.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

constexpr auto kMethods = {CurvatureMethod::cotangent, CurvatureMethod::taubin};

ScalarField curvature(const Mesh& mesh, CurvatureMethod method) {
  return mean_curvature(mesh.vertices, mesh.faces, method);
}

// Corner by corner, with angles, as in the paper.
ScalarField meyers_curvature(const Mesh& mesh) {
  const std::size_t n = mesh.vertices.size();
  std::vector<Vec3> sums(n, Vec3::Zero()), normals(n, Vec3::Zero());
  std::vector<double> areas(n, 0);
  for (const Triangle& face : mesh.faces) {
    std::array<Vec3, 3> p;
    std::array<double, 3> angle;
    for (std::size_t k = 0; k < 3; ++k) p[k] = mesh.vertices[index(face[k])];
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 a = p[(k + 1) % 3] - p[k], b = p[(k + 2) % 3] - p[k];
      angle[k] = std::acos(a.dot(b) / (a.norm() * b.norm()));
    }
    const Vec3 doubled = (p[1] - p[0]).cross(p[2] - p[0]);
    const double area = doubled.norm() / 2, largest = *std::ranges::max_element(angle);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3, last = (k + 2) % 3, i = index(face[k]);
      normals[i] += doubled;
      sums[i] += (p[k] - p[next]) / std::tan(angle[last]) + (p[k] - p[last]) / std::tan(angle[next]);
      if (largest > std::acos(0.0))
        areas[i] += angle[k] == largest ? area / 2 : area / 4;
      else
        areas[i] += ((p[k] - p[next]).squaredNorm() / std::tan(angle[last]) +
                     (p[k] - p[last]).squaredNorm() / std::tan(angle[next])) /
                    8;
    }
  }
  ScalarField result(n);
  for (std::size_t i = 0; i < n; ++i)
    result[i] = std::copysign((sums[i] / (2 * areas[i])).norm() / 2, sums[i].dot(normals[i]));
  return result;
}

// Taubin's tensor, built and decomposed.
ScalarField taubins_curvature(const Mesh& mesh) {
  const std::size_t n = mesh.vertices.size();
  std::vector<Vec3> normals(n, Vec3::Zero());
  for (const Triangle& face : mesh.faces) {
    const auto at = [&](std::size_t k) { return mesh.vertices[index(face[k])]; };
    for (const std::int32_t i : face) normals[index(i)] += (at(1) - at(0)).cross(at(2) - at(0)) / 2;
  }
  ScalarField result(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 normal = normals[i].normalized(), p = mesh.vertices[i];
    Eigen::Matrix3d tensor = Eigen::Matrix3d::Zero();
    double weights = 0;
    for (const Triangle& face : mesh.faces) {
      if (std::ranges::find(face, static_cast<std::int32_t>(i)) == face.end()) continue;
      const auto at = [&](std::size_t k) { return mesh.vertices[index(face[k])]; };
      const double area = (at(1) - at(0)).cross(at(2) - at(0)).norm() / 2;
      for (const std::int32_t j : face) {
        if (j == static_cast<std::int32_t>(i)) continue;
        const Vec3 edge = mesh.vertices[index(j)] - p;
        const Vec3 tangent = (normal * normal.dot(edge) - edge).normalized();
        tensor += area * (2 * normal.dot(edge) / edge.squaredNorm()) * tangent * tangent.transpose();
        weights += area;
      }
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(tensor / weights);
    std::vector<std::pair<double, double>> by_normal;  // |cosine to the normal|, eigenvalue
    for (int k = 0; k < 3; ++k)
      by_normal.emplace_back(std::abs(solver.eigenvectors().col(k).dot(normal)), solver.eigenvalues()[k]);
    std::ranges::sort(by_normal);
    const double a = by_normal[0].second, b = by_normal[1].second;
    result[i] = -((3 * a - b) + (3 * b - a)) / 2;
  }
  return result;
}

void expect_same(const ScalarField& a, const ScalarField& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], 1e-9 * (1 + std::abs(b[i]))) << i;
}

TEST(MeanCurvature, EqualsThePapersFormulasWrittenOut) {
  for (const Mesh& mesh :
       {shapes::bumpy_sphere(3, 0.5), shapes::torus(2, 0.7, 31, 17), shapes::tetrahedron()}) {
    expect_same(curvature(mesh, CurvatureMethod::cotangent), meyers_curvature(mesh));
    expect_same(curvature(mesh, CurvatureMethod::taubin), taubins_curvature(mesh));
  }
}

TEST(MeanCurvature, OfASphereIsOneOverItsRadius) {
  for (const CurvatureMethod method : kMethods) {
    Mesh sphere = shapes::sphere(4);
    EXPECT_THAT(curvature(sphere, method), Each(DoubleNear(1, 0.03))) << name_of(method);
    for (Vec3& v : sphere.vertices) v *= 5;
    EXPECT_THAT(curvature(sphere, method), Each(DoubleNear(0.2, 0.006))) << name_of(method);
  }
}

TEST(MeanCurvature, OfAPlaneIsZeroUpToTheEnds) {
  for (const CurvatureMethod method : kMethods)
    EXPECT_THAT(curvature(shapes::grid(20), method), Each(DoubleNear(0, 1e-9))) << name_of(method);
}

// --- points without a curvature of their own

TEST(MeanCurvatureDegenerate, PointsWithoutFacesTakeTheNearestValue) {
  Mesh mesh = shapes::bumpy_sphere(2);
  const ScalarField alone = curvature(mesh, CurvatureMethod::cotangent);
  mesh.vertices.push_back(1.01 * mesh.vertices[17]);
  const ScalarField found = curvature(mesh, CurvatureMethod::cotangent);
  EXPECT_EQ(found.back(), alone[17]);
  EXPECT_EQ(ScalarField(found.begin(), found.end() - 1), alone);
}

TEST(MeanCurvatureDegenerate, EdgesOfThreeFacesHaveNoLaplacian) {
  Mesh mesh = shapes::grid(10);
  mesh.vertices.emplace_back(0.5, 0.5, 0.4);
  mesh.faces.push_back({48, 49, static_cast<std::int32_t>(mesh.vertices.size()) - 1});  // a fin
  EXPECT_THAT(curvature(mesh, CurvatureMethod::cotangent), Each(DoubleNear(0, 1e-9)));
}

TEST(MeanCurvatureDegenerate, FacesWithoutAreaCountAsNone) {
  const Mesh mesh = shapes::bumpy_sphere(2);
  Mesh more = mesh;
  more.faces.insert(more.faces.end(), {{3, 3, 9}, {4, 4, 4}});
  for (const CurvatureMethod method : kMethods) EXPECT_EQ(curvature(more, method), curvature(mesh, method));
}

TEST(MeanCurvatureDegenerate, ThinFacesHaveBoundedTerms) {
  Mesh mesh = shapes::grid(10);
  // Vertex 49 almost at its neighbour 48: slivers with cotangents of about 1e9.
  mesh.vertices[49] = mesh.vertices[48] + Vec3(1e-10, 0, 0);
  for (const CurvatureMethod method : kMethods)
    for (const double value : curvature(mesh, method)) ASSERT_NEAR(value, 0, 1e-3) << name_of(method);
}

TEST(MeanCurvature, IsInverseToTheSize) {
  const Mesh mesh = shapes::bumpy_sphere(2);
  for (const CurvatureMethod method : kMethods) {
    const ScalarField expected = curvature(mesh, method);
    for (const int power : {-40, -10, 10, 40}) {
      Mesh scaled = mesh;
      for (Vec3& v : scaled.vertices) v *= std::ldexp(1, power);
      ScalarField found = curvature(scaled, method);
      for (double& value : found) value = std::ldexp(value, power);
      EXPECT_THAT(found, Pointwise(DoubleNear(1e-9), expected)) << power;
    }
  }
}

}  // namespace
}  // namespace salbench
