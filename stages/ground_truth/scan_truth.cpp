// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/ground_truth/scan_truth.h"

#include <algorithm>
#include <string>
#include <vector>

#include "stages/core/errors.h"
#include "stages/geometry/neighbours.h"

namespace salbench {
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
      if (point != kHidden && std::find(seen.begin(), seen.end(), point) == seen.end()) seen.push_back(point);
    }
  }
  return truth;
}

}  // namespace salbench
