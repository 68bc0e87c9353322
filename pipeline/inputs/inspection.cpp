// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/inputs/inspection.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "io/file.h"
#include "pipeline/inputs/given_truth.h"
#include "pipeline/inputs/inputs.h"
#include "pipeline/inputs/loading.h"
#include "pipeline/inputs/sizes.h"
#include "stages/core/errors.h"
#include "stages/core/parallel.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

void add_points(ItemFacts& facts, Points points) {
  facts.points = points.size();
  facts.diagonal = diagonal_of(points);
}

void add_truth(ItemFacts& facts, const GroundTruth& truth) {
  facts.has_truth = true;
  facts.participants = std::max(truth.viewers.size(), truth.picks.size());
  for (const auto& picks : truth.picks) facts.picks += picks.size();
  if (truth.saliency.empty()) facts.seen = facts.points;
  for (const double value : truth.saliency) {
    if (std::isnan(value)) continue;
    ++facts.seen;
    facts.low = std::fmin(facts.low, value);
    facts.high = std::fmax(facts.high, value);
  }
}

void read_item(const Family& family, const FilesOfUnit& shape_files, const FilesOfUnit& truth_files,
               ItemFacts& facts) {
  const std::vector<FileData> shape = read_all(shape_files);
  const Files in_shape{family.source, family.name, shape};
  if (facts.is_cloud) {
    const PointCloud cloud = load_cloud(in_shape, Remark{facts.remark});
    add_points(facts, cloud.points);
    if (truth_files.empty()) return;
    const std::vector<FileData> truth = read_all(truth_files);
    add_truth(facts, measured_cloud_truth(cloud, {}, {family.source, family.name, truth}));
  } else {
    const Mesh mesh = load_mesh(in_shape, Remark{facts.remark});
    add_points(facts, mesh.vertices);
    facts.faces = mesh.faces.size();
    if (truth_files.empty()) return;
    const std::vector<FileData> truth = read_all(truth_files);
    add_truth(facts, measured_truth(mesh, {family.source, family.name, truth}));
  }
}

void add_files_below(const fs::path& folder, std::vector<std::string>& files) {
  for (const FolderEntry& entry : list_folder(folder)) {
    if (entry.path.filename().string().starts_with('.')) continue;
    if (!entry.is_folder)
      files.push_back(entry.path);
    else if (!fs::is_symlink(entry.path))  // a link to a folder above would be followed for ever
      add_files_below(entry.path, files);
  }
}

std::vector<std::string> unused_files(const fs::path& root, const Dataset& dataset) {
  std::set<std::string> used(dataset.read.begin(), dataset.read.end());
  for (const DatasetItem& item : dataset.items) {
    used.insert(item.mesh);
    used.insert(item.saliency.begin(), item.saliency.end());
    used.insert(item.picks.begin(), item.picks.end());
    for (const MaskFile& mask : item.masks) used.insert(mask.path);
  }
  std::vector<std::string> files;
  add_files_below(root, files);
  std::erase_if(files, [&](const std::string& file) { return used.contains(file); });
  std::ranges::sort(files, natural_less);
  return files;
}

// A unit that no description names may be mixed all the same. Of the views of a shape the first tells.
void note_odd_sizes(DataInspection& found) {
  std::vector<double> diagonals;
  for (const ItemFacts& item : found.items) diagonals.push_back(item.diagonal);
  const std::vector<std::string> odd = odd_sizes(diagonals);
  std::set<std::string_view> named;
  for (std::size_t i = 0; i < odd.size(); ++i)
    if (!odd[i].empty() && named.insert(found.items[i].shape).second)
      found.notes.push_back(
          fmt::format("{}: {}: if it is in another unit, scale it; `units:` in a description makes it fail",
                      found.items[i].shape, odd[i]));
}

}  // namespace

std::size_t DataInspection::n_shapes() const {
  std::set<std::string_view> shapes;
  for (const ItemFacts& item : items) shapes.insert(item.shape);
  return shapes.size();
}

std::vector<std::string> DataInspection::problems() const {
  std::vector<std::string> all;
  for (const ItemFacts& item : items)
    if (!item.problem.empty()) all.push_back(fmt::format("{}: {}", item.name, item.problem));
  all.insert(all.end(), notes.begin(), notes.end());
  return all;
}

DataInspection inspect_data(const fs::path& root, std::span<const Layout> layouts) {
  fs::path folder = root.lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();
  Dataset dataset = find_dataset(folder, layouts);
  DataInspection found{.layout = dataset.layout,
                       .positives = format_of(dataset.items[0]).values.positives,
                       .scale = dataset.unit.scale,
                       .items = {},
                       .notes = dataset.notes,
                       .unused = unused_files(folder, dataset)};
  const bool has_unit = !dataset.unit.where.empty();
  if (!dataset.no_splits.empty()) found.notes.push_back(dataset.no_splits);
  const Inputs inputs = read_inputs(std::move(dataset));
  const std::vector<Family>& families = inputs.units.families();
  found.items.resize(families.size());
  parallel_ranges(families.size(), 1, [&](std::size_t i, std::size_t) {
    const DatasetItem& item = item_of(families[i].source);
    ItemFacts& facts = found.items[i];
    facts.name = item.name;
    facts.shape = item.shape_name();
    facts.view = item.view;
    facts.split = item.split;
    facts.category = item.category;
    facts.of_camera = !item.cameras.empty();
    facts.is_cloud = families[i].level == kClouds;
    try {
      read_item(families[i], inputs.shape_files->files[i], inputs.truth_files->files[i], facts);
    } catch (const InputError& error) {
      facts.problem = error.what();
    }
  });
  if (!has_unit) note_odd_sizes(found);
  for (ItemFacts& item : found.items) item.diagonal *= found.scale;
  return found;
}

}  // namespace salbench
