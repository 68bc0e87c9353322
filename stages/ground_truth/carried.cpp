// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/ground_truth/carried.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "stages/core/check.h"
#include "stages/core/errors.h"
#include "stages/core/field.h"
#include "stages/geometry/mesh_ops.h"
#include "stages/geometry/neighbours.h"

namespace salbench {
namespace {

constexpr double kUnseen = std::numeric_limits<double>::quiet_NaN();

}  // namespace

ScalarField vertex_values_of_faces(Points vertices, Surface faces, std::span<const double> values) {
  if (values.size() != faces.size())
    throw ShapeError("there are " + std::to_string(values.size()) + " values for " +
                     std::to_string(faces.size()) + " faces");
  require_finite(values, "the values of faces", true);
  ScalarField sums(vertices.size()), areas(vertices.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (std::isnan(values[f])) continue;
    const double twice_the_area = face_area_vector(vertices, faces[f]).norm();
    for (const std::int32_t vertex : faces[f]) {
      sums[index(vertex)] += twice_the_area * values[f];
      areas[index(vertex)] += twice_the_area;
    }
  }
  ScalarField result(vertices.size(), kUnseen);
  for (std::size_t i = 0; i < result.size(); ++i)
    if (areas[i] > 0) result[i] = sums[i] / areas[i];
  return result;
}

ScalarField vertex_values_of_samples(Points vertices, Points samples, std::span<const double> values,
                                     double max_distance) {
  CHECK_EQ(values.size(), samples.size());
  CHECK_GT(samples.size(), 0U);
  const KdTree tree(samples);
  ScalarField result;
  result.reserve(vertices.size());
  for (const Vec3& vertex : vertices) {
    const auto nearest = static_cast<std::size_t>(tree.nearest(vertex));
    result.push_back((samples[nearest] - vertex).norm() <= max_distance ? values[nearest] : kUnseen);
  }
  return result;
}

namespace {

constexpr std::int32_t kHidden = -1;  // no scan point has this vertex as its nearest

void require_fits(const Mesh& mesh, const GroundTruth& truth) {
  const std::size_t n = mesh.vertices.size();
  if (!truth.saliency.empty() && truth.saliency.size() != n)
    throw ShapeError("the ground truth has " + std::to_string(truth.saliency.size()) +
                     " saliency values, but the mesh has " + std::to_string(n) + " vertices");
  for (const auto& participant : truth.picks)
    for (const std::int32_t vertex : participant)
      if (vertex < 0 || index(vertex) >= n)
        throw ShapeError("the ground truth has a pick at vertex " + std::to_string(vertex) +
                         " (0-based), but the mesh has " + std::to_string(n) + " vertices");
}

std::vector<std::int32_t> nearest_vertices(const Scan& scan, const Mesh& mesh) {
  if (!scan.points.empty() && mesh.vertices.empty()) throw ShapeError("the scan's mesh has no vertices");
  const KdTree tree(mesh.vertices);
  std::vector<std::int32_t> nearest;
  nearest.reserve(scan.points.size());
  for (const Vec3& point : scan.points) nearest.push_back(tree.nearest(point));
  return nearest;
}

}  // namespace

GroundTruth scan_ground_truth(const Scan& scan, const Mesh& mesh, const GroundTruth& mesh_truth) {
  require_fits(mesh, mesh_truth);
  const std::vector<std::int32_t> nearest = nearest_vertices(scan, mesh);

  GroundTruth truth;
  truth.simulated = mesh_truth.simulated;
  if (!mesh_truth.saliency.empty())
    for (const std::int32_t vertex : nearest) truth.saliency.push_back(mesh_truth.saliency[index(vertex)]);

  std::vector<std::int32_t> first_point(mesh.vertices.size(), kHidden);
  for (std::size_t p = nearest.size(); p-- > 0;)
    first_point[index(nearest[p])] = static_cast<std::int32_t>(p);
  for (const auto& participant : mesh_truth.picks) {
    std::vector<std::int32_t>& seen = truth.picks.emplace_back();
    for (const std::int32_t vertex : participant) {
      const std::int32_t point = first_point[index(vertex)];
      if (point != kHidden && std::ranges::find(seen, point) == seen.end()) seen.push_back(point);
    }
  }
  return truth;
}

}  // namespace salbench
