// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/catalog/loading.h"

#include <string>
#include <utility>

#include <spdlog/spdlog.h>

#include "io/cloud_file.h"
#include "io/mesh_file.h"
#include "stages/core/mesh_check.h"

namespace salbench {
Mesh load_mesh(const FilesOf<Source::shape_file>& file) {
  CheckedMesh checked = check_mesh(parse_mesh(file.data[0].text(), file.item.mesh));
  for (const std::string& warning : warnings(checked.report)) spdlog::warn("{}: {}", file.name, warning);
  return std::move(checked.mesh);
}

PointCloud load_cloud(const FilesOf<Source::shape_file>& file) {
  CheckedCloud checked = check_cloud(parse_cloud(file.data[0].text(), file.item.mesh));
  for (const std::string& warning : checked.warnings) spdlog::warn("{}: {}", file.name, warning);
  return std::move(checked.cloud);
}

Mesh mesh_of(const PointCloud& cloud, Surface surface) {
  return {cloud.points, {surface.begin(), surface.end()}};
}

}  // namespace salbench
