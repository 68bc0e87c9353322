// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/catalog/loading.h"

#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "io/cloud_file.h"
#include "io/ground_truth_file.h"
#include "io/mesh_file.h"
#include "stages/core/errors.h"
#include "stages/core/mesh_check.h"
#include "stages/core/smoothing.h"

namespace salbench {
namespace {

GroundTruth parsed_ground_truth(const FilesOf<Source::truth_files>& files, std::size_t n_points) {
  std::vector<std::string_view> texts;
  for (const SourceData& file : files.data) texts.push_back(file.text());
  GroundTruth truth = parse_ground_truth(files.item, texts, n_points);
  if (truth.saliency.empty() && truth.picks.empty())
    throw InputError(
        fmt::format("{}: nobody picked a point and there is no saliency file; remove the empty .pid files",
                    files.item.picks.front().string()));
  return truth;
}

}  // namespace

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

GroundTruth load_ground_truth(const Mesh& mesh, const FilesOf<Source::truth_files>& files) {
  GroundTruth truth = parsed_ground_truth(files, mesh.vertices.size());
  if (truth.saliency.empty()) truth.saliency = smoothed_picks(mesh, truth.picks);
  return truth;
}

Mesh mesh_of(const PointCloud& cloud, Surface surface) {
  return {cloud.points, {surface.begin(), surface.end()}};
}

GroundTruth load_cloud_ground_truth(const PointCloud& cloud, Surface surface,
                                    const FilesOf<Source::truth_files>& files) {
  GroundTruth truth = parsed_ground_truth(files, cloud.size_in_file());
  truth.picks = picks_left(cloud, std::move(truth.picks));
  truth.saliency = truth.saliency.empty() ? smoothed_picks(mesh_of(cloud, surface), truth.picks)
                                          : values_left(cloud, truth.saliency);
  return truth;
}

}  // namespace salbench
