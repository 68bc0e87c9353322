// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/inputs/given_truth.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numeric>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "io/cloud_file.h"
#include "io/file.h"
#include "io/ground_truth_file.h"
#include "io/mat_file.h"
#include "io/mesh_file.h"
#include "io/values_file.h"
#include "pipeline/config/option_text.h"
#include "pipeline/inputs/inputs.h"
#include "pipeline/inputs/loading.h"
#include "stages/core/errors.h"
#include "stages/core/mesh_ops.h"
#include "stages/core/seen.h"
#include "stages/core/smoothing.h"
#include "stages/ground_truth/carried.h"
#include "stages/ground_truth/positives.h"
#include "stages/ground_truth/visible.h"
#include "stages/models/hs.h"

namespace salbench {

const TruthFormat& format_of(const DatasetItem& item) {
  static const TruthFormat defaults;
  return item.format ? *item.format : defaults;
}

namespace {

// " (per: face, column: 3)"; nothing for the defaults, which older keys imply.
template <class Format>
std::string described(const Format& format) {
  std::string lines = key_text(format);
  if (lines.empty()) return {};
  lines.pop_back();
  for (std::size_t end = lines.find('\n'); end != std::string::npos; end = lines.find('\n', end))
    lines.replace(end, 1, ", ");
  return fmt::format(" ({})", lines);
}

// " from [0, 0, 5]", "from direction [0, 0, 1]"; nothing where all was seen.
std::string camera_text(const DatasetItem& item, std::size_t k) {
  if (item.cameras.empty()) return {};
  const auto& [place, at_infinity] = item.cameras[k].from;
  return fmt::format(" from {}[{}, {}, {}]", at_infinity ? "direction " : "", place.x(), place.y(),
                     place.z());
}

std::string saliency_name(const DatasetItem& item, std::size_t k) {
  const std::string name = item.by_viewer             ? fmt::format("saliency of viewer {}", k)
                           : item.saliency.size() > 1 ? fmt::format("saliency file {}", k)
                                                      : "saliency file";
  const ValuesFormat& values = format_of(item).values;
  // Keys without this are of programs that took rows as they stood.
  const bool may_be_numbered = !values.column.empty() && values.per != ValuePer::point;
  return name + described(values) + (may_be_numbered ? ", rows by their numbers" : "") + camera_text(item, k);
}

// True if the saliency files may say that something was not seen.
bool may_hide(const DatasetItem& item) {
  const ValuesFormat& values = format_of(item).values;
  return !item.saliency.empty() && (!item.masks.empty() || !item.cameras.empty() || !values.unseen.empty() ||
                                    values.per != ValuePer::vertex);
}

bool are_in_file_order(const DatasetItem& item) {
  return format_of(item).values.per == ValuePer::face && !item.saliency.empty();
}

// Of values, what is no matter of reading them.
ValuesFormat positives_alone(const DatasetItem& item) {
  ValuesFormat format;
  format.positives = format_of(item).values.positives;
  return format;
}

// The columns of ground truth alone, or those of the points.
ColumnsFormat truth_columns(const DatasetItem& item) {
  ColumnsFormat columns;
  columns.density = format_of(item).columns.density;
  columns.flag = format_of(item).columns.flag;
  return columns;
}

ColumnsFormat shape_columns(const DatasetItem& item) {
  ColumnsFormat columns = format_of(item).columns;
  // Padding is told by all columns.
  if (columns.padding == Padding::none) columns.density = columns.flag = "";
  return columns;
}

bool has_truth_in_columns(const DatasetItem& item) {
  return has_columns(item) && format_of(item).columns.has_truth();
}

std::string titled(std::string_view kind, const std::filesystem::path& path) {
  return fmt::format("{} {}", kind, path.filename().string());
}

// A file that fails its item as soon as it is read.
File unusable(std::string name, std::string place, std::string why) {
  auto fail = [why = std::move(why)]() -> FileData { throw InputError(why); };
  return {.name = std::move(name),
          .place = std::move(place),
          .read = std::make_shared<const ReadFile>(std::move(fail))};
}

ScalarField parse_mask(std::string_view bytes, const std::string& name, const Elements& elements) {
  ScalarField mask =
      parse_columns(bytes, name, {""}, {}, elements, [](std::span<const double> row) -> std::string_view {
        return row[0] == 0 || row[0] == 1 ? "" : "a mask has 0 for hidden and 1 for seen, and nothing else";
      })[0];
  if (std::ranges::none_of(mask, [](double seen) { return seen == 1; }))
    throw InputError(
        fmt::format("{}: hides everything: nothing is left to be scored; correct it, or take it "
                    "and its ground truth away",
                    name));
  return mask;
}

// The points that the files describe. A cloud may have left out some that its file has.
struct Target {
  Points points;
  Surface surface = {};               // what may hide them
  const PointCloud* cloud = nullptr;  // none: a mesh
  Mesh as_written = {};               // with the faces of the mesh's file, where values are per face

  Elements in_file() const {
    if (cloud != nullptr) return {cloud->size_in_file(), "point cloud", "point", "points"};
    return {points.size()};
  }
  Elements described_by(const ValuesFormat& format) const {
    if (format.per == ValuePer::face) return {as_written.faces.size(), "mesh", "face", "faces"};
    return in_file();
  }
  ScalarField left(ScalarField values) const {
    return cloud != nullptr ? values_left(*cloud, values) : std::move(values);
  }
};

// Hides the values that the item's camera of this number does not see.
void hide_unseen(ScalarField& values, const Target& target, const DatasetItem& item, std::size_t k) {
  if (item.cameras.empty()) return;
  const std::vector<bool> visible = visible_points(target.points, target.surface, item.cameras[k].from);
  if (std::ranges::none_of(visible, std::identity()))
    throw InputError(fmt::format("{}: this camera sees no point of {}: correct its place",
                                 item.cameras[k].where, item.mesh));
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!visible[i]) values[i] = std::numeric_limits<double>::quiet_NaN();
}

// A mask's file, if there is one.
struct Mask {
  std::string name = {};
  std::string_view bytes = {};

  ScalarField read(const Elements& elements) const {
    return name.empty() ? ScalarField{} : parse_mask(bytes, name, elements);
  }
};

// What one file holds, before its mask is applied.
ValuesAsRead read_values(const Target& target, const ValuesFormat& format, std::string_view bytes,
                         const std::string& path, const Mask& mask) {
  ValuesAsRead read{.file = std::filesystem::path(path).filename(), .per = name_of(format.per), .values = {}};
  TruthValues truth = parse_truth_values(bytes, path, format, target.described_by(format));
  read.values = std::move(truth.values);
  read.points = std::move(truth.points);
  const Elements elements = format.per == ValuePer::point
                                ? Elements{read.values.size(), "file", "point", "points"}
                                : target.described_by(format);
  read.mask = mask.read(elements);
  return read;
}

// The values that are not hidden, on the points.
ScalarField on_points(const Target& target, const ValuesFormat& format, const ValuesAsRead& read) {
  ScalarField values = read.values;
  for (std::size_t i = 0; i < read.mask.size(); ++i)
    if (read.mask[i] == 0) values[i] = std::numeric_limits<double>::quiet_NaN();
  if (format.per == ValuePer::face)
    return vertex_values_of_faces(target.as_written.vertices, target.as_written.faces, values);
  if (format.per == ValuePer::vertex) return target.left(std::move(values));
  return vertex_values_of_samples(target.points, read.points, values,
                                  format.max_distance * bounding_radius(target.points));
}

void add_saliency(GroundTruth& truth, const DatasetItem& item, std::vector<ScalarField> maps) {
  if (maps.empty()) return;
  std::vector<std::size_t> all(maps.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  truth.saliency = maps.size() == 1 ? maps[0] : mean_of_seen(maps, all);
  if (std::all_of(truth.saliency.begin(), truth.saliency.end(),
                  [](double value) { return std::isnan(value); }))
    throw InputError(
        fmt::format("{}: no point of the shape has a value; expected are values of what was seen, and points "
                    "within max_distance of it",
                    item.saliency[0]));
  if (item.by_viewer && maps.size() >= kMinParticipants) truth.viewers = std::move(maps);
}

// Picks where nothing was seen do not count. Their participants stay.
void drop_picks_where(const auto& hidden, GroundTruth& truth) {
  for (std::vector<std::int32_t>& picks : truth.picks)
    std::erase_if(picks, [&](std::int32_t pick) { return hidden(index(pick)); });
}

// The picks that count, or those that a rule makes of densities.
GroundTruth with_positives(GroundTruth truth, const DatasetItem& item) {
  if (may_hide(item)) drop_picks_where([&](std::size_t i) { return std::isnan(truth.saliency[i]); }, truth);
  const auto [by, percent] = positive_rule(format_of(item).values);
  if (by == PositiveRule::By::picks || truth.saliency.empty()) return truth;
  std::vector<std::int32_t> positives = by == PositiveRule::By::mean ? points_above_mean(truth.saliency)
                                                                     : points_on_top(truth.saliency, percent);
  if (!positives.empty()) truth.picks = {std::move(positives)};
  return truth;
}

// That of picks alone is made from them, and is seen where the camera sees.
GroundTruth with_saliency(GroundTruth truth, const Mesh& shape, const DatasetItem& item) {
  if (!truth.saliency.empty()) return truth;
  ScalarField seen(shape.vertices.size());
  hide_unseen(seen, {.points = shape.vertices, .surface = shape.faces}, item, 0);
  drop_picks_where([&](std::size_t i) { return std::isnan(seen[i]); }, truth);
  truth.saliency = smoothed_picks(shape, truth.picks);
  for (std::size_t i = 0; i < seen.size(); ++i) truth.saliency[i] += seen[i];
  return truth;
}

// Flags of points that the cloud left out do not count.
GroundTruth truth_in_columns(const Target& target, const DatasetItem& item, const Files& files) {
  ColumnTruth found = parse_column_truth(files.data[0].text(), item.mesh, format_of(item).columns);
  GroundTruth truth;
  if (!found.saliency.empty()) truth.saliency = target.left(std::move(found.saliency));
  const std::vector<std::int32_t> numbers = numbers_left(*target.cloud);
  std::erase_if(found.picks,
                [&](std::int32_t pick) { return numbers.at(static_cast<std::size_t>(pick)) < 0; });
  if (!found.picks.empty()) truth.picks = {std::move(found.picks)};
  if (truth.saliency.empty() && truth.picks.empty())
    throw InputError(
        fmt::format("{}: no point has its flag set: there is nothing to compare with", item.mesh));
  return truth;
}

// All but the saliency of picks alone. Picks count the points of the file.
GroundTruth read_truth(Target target, const Files& files, std::vector<ValuesAsRead>* as_read) {
  const DatasetItem& item = item_of(files.source);
  const TruthFormat& format = format_of(item);
  if (has_truth_in_columns(item)) return truth_in_columns(target, item, files);
  auto file = files.data.begin();
  if (are_in_file_order(item)) target.as_written = parse_mesh((file++)->text(), item.mesh);
  std::vector<ScalarField> maps;
  const auto masks = file + static_cast<std::ptrdiff_t>(item.saliency.size());
  for (std::size_t k = 0; k < item.saliency.size(); ++k) {
    const Mask mask =
        item.masks.empty() ? Mask{} : Mask{item.masks[k].path, masks[static_cast<std::ptrdiff_t>(k)].text()};
    ValuesAsRead read = read_values(target, format.values, (file++)->text(), item.saliency[k], mask);
    maps.push_back(on_points(target, format.values, read));
    hide_unseen(maps.back(), target, item, k);
    if (as_read != nullptr) as_read->push_back(std::move(read));
  }
  if (as_read != nullptr && item.masks.empty() && format.values.per == ValuePer::vertex &&
      (maps.size() == 1 || item.by_viewer))
    as_read->clear();
  file += std::ssize(item.masks);

  GroundTruth truth;
  add_saliency(truth, item, std::move(maps));
  for (const auto& path : item.picks)
    truth.picks.push_back(parse_truth_picks((file++)->text(), path, format.indices, target.in_file()));
  if (std::all_of(truth.picks.begin(), truth.picks.end(), [](const auto& picks) { return picks.empty(); }))
    truth.picks.clear();
  if (truth.saliency.empty() && truth.picks.empty())
    throw InputError(
        fmt::format("{}: nobody picked a point and there is no saliency file; remove the empty {} files",
                    item.picks.front(), std::filesystem::path(item.picks.front()).extension().string()));
  return truth;
}

}  // namespace

File mesh_file_of(const DatasetItem& item) {
  return {.name = "mesh file " + lower_case_extension(item.mesh),
          .place = item.mesh,
          .title = titled("mesh file", item.mesh)};
}

FilesOfUnit truth_files_of(const DatasetItem& item) {
  FilesOfUnit files;
  if (!item.problem.empty()) return {unusable("split", item.mesh, item.problem)};
  if (item.indexed && !item.indexed->has_truth) return {};
  if (item.indexed)
    return {{.name = "ground truth in one form" + (item.view.empty() ? "" : ", view " + item.view),
             .place = item.mesh}};
  if (has_truth_in_columns(item))
    return {{.name = "ground truth in columns" + described(truth_columns(item)) +
                     described(positives_alone(item)),
             .place = item.mesh}};
  if (are_in_file_order(item)) files.push_back(mesh_file_of(item));
  for (std::size_t k = 0; k < item.saliency.size(); ++k)
    files.push_back({.name = saliency_name(item, k),
                     .place = item.saliency[k],
                     .title = titled("saliency file", item.saliency[k])});
  for (std::size_t k = 0; k < item.masks.size(); ++k) {
    const std::string name = fmt::format("mask {}", k);
    const auto& [path, missing] = item.masks[k];
    files.push_back(missing.empty() ? File{.name = name, .place = path, .title = titled("mask", path)}
                                    : unusable(name, path, missing));
  }
  for (std::size_t k = 0; k < item.picks.size(); ++k)
    files.push_back({.name = fmt::format("picks {}{}{}{}", k, described(format_of(item).indices),
                                         may_hide(item) ? " of what was seen" : "",
                                         item.saliency.empty() && k == 0 ? camera_text(item, k) : ""),
                     .place = item.picks[k]});
  return files;
}

bool has_columns(const DatasetItem& item) { return is_column_cloud(item.mesh, format_of(item).columns); }

std::string column_cloud_name(const DatasetItem& item) {
  return fmt::format("point cloud file {}{}", lower_case_extension(item.mesh),
                     described(shape_columns(item)));
}

GroundTruth measured_truth(const Mesh& mesh, const Files& files, std::vector<ValuesAsRead>* as_read) {
  const DatasetItem& item = item_of(files.source);
  if (item.indexed) return truth_in_form(files.data[0].text(), item.mesh, item.view);
  return with_positives(read_truth({.points = mesh.vertices, .surface = mesh.faces}, files, as_read), item);
}

GroundTruth given_truth(const Mesh& mesh, const Files& files) {
  return with_saliency(measured_truth(mesh, files), mesh, item_of(files.source));
}

GroundTruth measured_cloud_truth(const PointCloud& cloud, Surface surface, const Files& files,
                                 std::vector<ValuesAsRead>* as_read) {
  const DatasetItem& item = item_of(files.source);
  if (item.indexed) return truth_in_form(files.data[0].text(), item.mesh, item.view);
  if (are_in_file_order(item))
    throw InputError(fmt::format("{}: has values per face, but {} is a point cloud, which has none",
                                 item.saliency[0], item.mesh));
  GroundTruth truth =
      read_truth({.points = cloud.points, .surface = surface, .cloud = &cloud}, files, as_read);
  truth.picks = picks_left(cloud, std::move(truth.picks));
  return with_positives(std::move(truth), item);
}

GroundTruth given_cloud_truth(const PointCloud& cloud, Surface surface, const Files& files) {
  return with_saliency(measured_cloud_truth(cloud, surface, files), mesh_of(cloud, surface),
                       item_of(files.source));
}

std::size_t participants_of(const DatasetItem& item) {
  if (item.indexed) return std::max(item.indexed->participants, item.indexed->viewers);
  return std::max(item.picks.size(), item.by_viewer ? item.saliency.size() : 0);
}

bool has_participants(const DatasetItem& item) { return participants_of(item) >= kMinParticipants; }

}  // namespace salbench
