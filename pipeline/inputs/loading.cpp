// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/inputs/loading.h"

#include <string>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "io/hdf5/one_form.h"
#include "io/shapes/cloud_file.h"
#include "io/shapes/mesh_file.h"
#include "pipeline/inputs/inputs.h"
#include "stages/core/mesh_check.h"
#include "stages/core/scale.h"

namespace salbench {
namespace {

std::string polygons_text(const PolygonCounts& polygons) {
  if (polygons.split == 0) return {};
  return fmt::format("{} polygons split into triangles, {} of them concave", polygons.split,
                     polygons.concave);
}

void make(const Remark& remark, const std::string& name, const std::string& polygons,
          const std::string& scale) {
  remark.text = polygons + (polygons.empty() || scale.empty() ? "" : "; ") + scale;
  if (!remark.text.empty()) spdlog::warn("{}: {}", name, remark.text);
}

PointCloud parsed_cloud(const Files& file) {
  const DatasetItem& item = item_of(file.source);
  const std::string& bytes = file.data[0].text();
  return item.indexed ? cloud_in_form(bytes, item.mesh) : parse_cloud(bytes, item.mesh);
}

}  // namespace

Mesh parsed_mesh(const Files& file, PolygonCounts* polygons) {
  const DatasetItem& item = item_of(file.source);
  return item.indexed ? mesh_in_form(file.data[0].text(), item.mesh, polygons)
                      : parse_mesh(file.data[0].text(), item.mesh, polygons);
}

Mesh load_mesh(const Files& file, const Remark& remark) {
  PolygonCounts polygons;
  Mesh mesh = parsed_mesh(file, &polygons);
  return usable_mesh(std::move(mesh), polygons, file.name, remark);
}

PointCloud load_cloud(const Files& file, const Remark& remark) {
  return usable_cloud(parsed_cloud(file), file.name, remark);
}

Mesh usable_mesh(Mesh as_written, const PolygonCounts& polygons, const std::string& item,
                 const Remark& remark) {
  CheckedMesh checked = check_mesh(std::move(as_written));
  for (const std::string& warning : warnings(checked.report)) spdlog::warn("{}: {}", item, warning);
  make(remark, item, polygons_text(polygons), odd_scale(checked.mesh.vertices));
  return std::move(checked.mesh);
}

PointCloud usable_cloud(PointCloud as_written, const std::string& item, const Remark& remark) {
  if (!as_written.dropped.empty())  // by an importer
    spdlog::warn("{}: {} of {} points dropped: they have no position", item, as_written.dropped.size(),
                 as_written.size_in_file());
  CheckedCloud checked = check_cloud(std::move(as_written));
  for (const std::string& warning : checked.warnings) spdlog::warn("{}: {}", item, warning);
  make(remark, item, {}, odd_scale(checked.cloud.points));
  return std::move(checked.cloud);
}

Mesh mesh_of(const PointCloud& cloud, Surface surface) {
  return {cloud.points, {surface.begin(), surface.end()}};
}

}  // namespace salbench
