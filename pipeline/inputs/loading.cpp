// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/inputs/loading.h"

#include <algorithm>
#include <cstdio>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "stages/geometry/mesh_check.h"
#include "stages/geometry/mesh_ops.h"

namespace salbench {
namespace {

std::string polygons_text(const PolygonCounts& polygons) {
  if (polygons.split == 0) return {};
  return fmt::format("{} polygons split into triangles, {} of them concave", polygons.split,
                     polygons.concave);
}

// Vertices that no face uses are kept as points, and count in the extent.
std::string isolated_text(const CheckedMesh& checked) {
  if (checked.report.isolated_vertices == 0) return {};
  const std::vector<Vec3>& all = checked.mesh.vertices;
  std::vector<bool> used(all.size());
  for (const Triangle& face : checked.mesh.faces)
    for (const std::int32_t i : face) used[index(i)] = true;
  std::string text =
      fmt::format("{} isolated vertices kept: no face uses them, the first is vertex {} (0-based)",
                  checked.report.isolated_vertices, std::ranges::find(used, false) - used.begin());
  std::vector<Vec3> of_faces;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (used[i]) of_faces.push_back(all[i]);
  constexpr double kMuch = 1.01;
  const double with = bounding_radius(all), without = bounding_radius(of_faces);
  if (with > kMuch * without)
    text += fmt::format("; R is {:.3g} with them and {:.3g} without, and maps depend on it: remove them",
                        with, without);
  return text;
}

// Usual lengths of a bounding box's diagonal: from an object of one millimetre in metres to one of a
// kilometre in millimetres. Smaller shapes have fewer than 1000 steps across in files with six decimals, the
// default of printf.
constexpr double kSmallest = 1e-3, kLargest = 1e6;
// Distance from the origin, in diagonals. Most files are in single precision (24 bits): at 1000 diagonals
// that leaves 16,000 steps across a shape, 100 or less between points, and normals turn by degrees.
constexpr double kFarthest = 1000;
constexpr double kSinglePrecision = 16777216;

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

// One line per shape.
void warn(const std::string& item, const std::vector<std::string>& found) {
  if (!found.empty()) spdlog::warn("{}: {}", item, fmt::join(found, "; "));
}

void make(const Remark& remark, const std::string& name, std::initializer_list<std::string> parts) {
  remark.text.clear();
  for (const std::string& part : parts)
    if (!part.empty()) remark.text += (remark.text.empty() ? "" : "; ") + part;
  if (!remark.text.empty()) spdlog::warn("{}: {}", name, remark.text);
}

}  // namespace

std::string odd_scale(std::span<const Vec3> points) {
  Eigen::AlignedBox3d box;
  for (const Vec3& p : points) box.extend(p);
  if (box.isEmpty()) return {};
  const double diagonal = box.diagonal().stableNorm();
  const double largest = box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).maxCoeff();
  std::string odd;
  if (diagonal < kSmallest || diagonal > kLargest)
    odd = "the bounding box has a diagonal of " + number(diagonal) + ": check the unit of length";
  if (largest > kFarthest * diagonal)
    odd += std::string(odd.empty() ? "" : "; ") + "coordinates reach " + number(largest / diagonal) +
           " diagonals of the bounding box from the origin: single precision has " +
           number(kSinglePrecision * diagonal / largest) + " steps across the shape";
  return odd;
}

Mesh usable_mesh(Mesh as_written, const PolygonCounts& polygons, const std::string& item,
                 const Remark& remark) {
  CheckedMesh checked = check_mesh(std::move(as_written));
  warn(item, warnings(checked.report));
  make(remark, item, {polygons_text(polygons), isolated_text(checked), odd_scale(checked.mesh.vertices)});
  return std::move(checked.mesh);
}

PointCloud usable_cloud(PointCloud as_written, const std::string& item, const Remark& remark) {
  if (!as_written.dropped.empty())  // dropped by the front
    spdlog::warn("{}: {} of {} points dropped: they have no position", item, as_written.dropped.size(),
                 as_written.size_in_file());
  CheckedCloud checked = check_cloud(std::move(as_written));
  warn(item, checked.warnings);
  make(remark, item, {odd_scale(checked.cloud.points)});
  return std::move(checked.cloud);
}

Mesh mesh_of(const PointCloud& cloud, Surface surface) {
  return {cloud.points, {surface.begin(), surface.end()}};
}

}  // namespace salbench
