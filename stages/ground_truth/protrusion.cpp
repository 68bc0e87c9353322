// SPDX-License-Identifier: GPL-3.0-or-later
// Explicit diffusion of the positions over edges: a step moves vertex i towards the mean of its neighbours.
// If the edges have the mean squared length e, that mean lies (e / 4) * Laplacian away. A vertex moves by the
// fraction step / e of it, so that diffusion has the same speed everywhere, independent of sampling density.
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "stages/core/field.h"
#include "stages/geometry/mesh_ops.h"
#include "stages/ground_truth/simulation.h"

namespace salbench {
namespace {

constexpr double kMaxSteps = 128;  // limits the time on very dense meshes, which then diffuse less far

std::vector<double> mean_squared_edges(const std::vector<Vec3>& points, const Adjacency& adjacency) {
  std::vector<double> squares(points.size(), 0.0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (const std::int32_t j : adjacency.of(i)) squares[i] += (at(points, j) - points[i]).squaredNorm();
    if (!adjacency.of(i).empty()) squares[i] /= static_cast<double>(adjacency.of(i).size());
  }
  return squares;
}

std::vector<Vec3> diffused(const Mesh& mesh, double unit) {
  const Adjacency adjacency = edge_adjacency(mesh.vertices.size(), mesh.faces);
  const std::vector<double> squares = mean_squared_edges(mesh.vertices, adjacency);
  const double wanted = 4 * unit * unit;
  // A vertex moves at most to the mean: steps of half the median leave room for shorter edges.
  std::vector<double> positive = squares;
  std::erase_if(positive, [](double square) { return !(square > 0); });
  const double step_square = upper_median(std::move(positive)) / 2;
  const double steps = std::clamp(std::ceil(wanted / step_square), 1.0, kMaxSteps);
  std::vector<double> fraction(squares.size(), 0.0);
  for (std::size_t i = 0; i < fraction.size(); ++i)
    if (squares[i] > 0) fraction[i] = std::min(1.0, wanted / steps / squares[i]);

  std::vector<Vec3> points = mesh.vertices, next(points.size());
  for (double step = 0; step < steps; ++step) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      Vec3 sum = Vec3::Zero();
      for (const std::int32_t j : adjacency.of(i)) sum += at(points, j) - points[i];
      next[i] = points[i];
      if (fraction[i] > 0) next[i] += fraction[i] / static_cast<double>(adjacency.of(i).size()) * sum;
    }
    std::swap(points, next);
  }
  return points;
}

std::vector<Vec3> vertex_normals(const Mesh& mesh) {
  std::vector<Vec3> normals = summed_area_vectors(mesh);
  for (Vec3& normal : normals)
    if (normal.squaredNorm() > 0) normal.normalize();
  return normals;
}

}  // namespace

ScalarField protrusion(const Mesh& mesh, double scale) {
  ScalarField result(mesh.vertices.size(), 0.0);
  const double unit = scale * std::sqrt(surface_area(mesh));
  if (!(unit > 0)) return result;
  const std::vector<Vec3> smooth = diffused(mesh, unit);
  const std::vector<Vec3> normals = vertex_normals(mesh);
  for (std::size_t i = 0; i < result.size(); ++i)
    result[i] = (mesh.vertices[i] - smooth[i]).dot(normals[i]) / unit;
  return result;
}

}  // namespace salbench
