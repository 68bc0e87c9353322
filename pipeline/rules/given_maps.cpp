// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/rules/given_maps.h"

#include <cmath>

#include <fmt/format.h>

#include "io/file.h"
#include "io/shapes/mesh_file.h"
#include "io/shapes/text_scanner.h"
#include "io/shapes/values_file.h"
#include "pipeline/inputs/inputs.h"
#include "stages/core/errors.h"
#include "stages/core/field.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

GivenMaps maps_in_folder(const fs::path& folder) {
  GivenMaps maps{.source = folder};
  for (const FolderEntry& entry : list_folder(folder)) {
    if (lower_case_extension(entry.path) != ".val") continue;
    if (!maps.items.insert(entry.path.stem()).second)
      throw ConfigError(fmt::format("--maps {} and {} differ by case alone: keep one of them",
                                    maps.files.at(entry.path.stem()).string(), entry.path.string()));
    maps.files[entry.path.stem()] = entry.path;
  }
  maps.read = [files = maps.files](const std::string& item) -> FileData {
    std::string text = read_file(files.at(item), kMaxItemBytes);
    return {file_digest(text), std::move(text)};
  };
  return maps;
}

// Maps are told apart by their own values, so that a file with a map more leaves the others as they are.
GivenMaps maps_in_file(const fs::path& path, const Front& front) try {
  GivenMaps maps{.source = path};
  for (const std::string& name : answering(front.names_of_maps, "a file of maps")(path))
    maps.items.insert(name);
  maps.read = [read_map = front.read_map, path](const std::string& item) -> FileData {
    ScalarField values = read_map(path, item);
    return {content_digest({column(item, values, "1", "")}), std::move(values)};
  };
  return maps;
} catch (const InputError& error) {
  throw ConfigError(fmt::format("--maps {}", error.what()));
}

ScalarField values_in(const FileData& data, const std::string& where) {
  const auto* values = std::get_if<ScalarField>(&data.content);
  return values != nullptr ? *values : parse_values(data.text(), where);
}

// What is wrong with the map or the mesh is said where they are used.
FileData of_triangles(FileData data, const std::string& item, const std::string& mesh_file) try {
  if (!has_mesh_extension(mesh_file)) return data;
  PolygonCounts counts;
  const Mesh mesh = parse_mesh(read_file(mesh_file, kMaxItemBytes), mesh_file, &counts);
  if (counts.split == 0) return data;
  const ScalarField of_faces = values_in(data, item);
  const bool of_vertices = of_faces.size() == mesh.vertices.size();  // first, where there are as many of both
  if (of_vertices || of_faces.size() != faces_in_file(counts, mesh.faces.size())) return data;
  ScalarField values;
  for (const std::int32_t face : faces_of_triangles(counts, mesh.faces.size()))
    values.push_back(of_faces[static_cast<std::size_t>(face)]);
  return {content_digest({column(item, values, "1", "")}), std::move(values)};
} catch (const InputError&) {
  return data;
}

}  // namespace

std::string GivenMaps::place(const std::string& item) const {
  if (const auto file = files.find(item); file != files.end()) return file->second.string();
  return is_folder(source) ? (source / (item + ".val")).string()
                           : fmt::format("{}: data set {}", source.string(), item);
}

ScalarField GivenMaps::checked(const FileData& data, const std::string& item, std::size_t n_points,
                               std::size_t n_faces, const PointCloud* cloud) const {
  const std::string where = place(item);
  ScalarField map = values_in(data, where);
  if (cloud != nullptr && map.size() == cloud->size_in_file()) map = values_left(*cloud, map);
  require_value_per_element(where, map.size(), n_points, n_faces);
  if (const std::string wrong = wrong_with_values(map); !wrong.empty())
    throw InputError(fmt::format("{}: {}", where, wrong));
  for (std::size_t i = 0; i < map.size(); ++i)
    if (matched && !(map[i] >= 0 && map[i] <= 1))
      throw InputError(
          fmt::format("{}: value {} (0-based) is {}: a matched map lies in [0, 1]; leave out "
                      "--matched to have it matched",
                      where, i, map[i]));
  return map;
}

GivenMaps find_given_maps(const fs::path& source, bool matched, const Front& front) {
  GivenMaps maps = is_folder(source) ? maps_in_folder(source) : maps_in_file(source, front);
  maps.matched = matched;
  return maps;
}

std::map<Level, FilesOfUnits> map_files(const std::shared_ptr<const GivenMaps>& maps, const Units& units,
                                        const std::vector<Level>& levels, bool on_faces) {
  const auto file_of = [&](const std::string& item, const std::string& mesh) {
    const auto read = [maps, item, mesh, on_faces] {
      if (maps->items.contains(item))
        return on_faces ? of_triangles(maps->read(item), item, mesh) : maps->read(item);
      throw InputError(fmt::format("{}: missing, although other items have a map", maps->place(item)));
    };
    return File{
        .name = "map file", .place = maps->place(item), .read_with = std::make_shared<ReadFile>(read)};
  };
  // Views of one shape that are scored by themselves may share its map.
  const auto name_of_map = [&](Unit unit) {
    const std::string name = units.name(unit);
    const Item& item = item_of(units, unit);
    return item.view.empty() || maps->items.contains(name)
               ? name
               : item.shape_name() + name.substr(item.name.size());
  };
  std::map<Level, FilesOfUnits> files;
  std::string example;  // of a name that would be one
  bool any = false;
  for (const Level level : levels) {
    const std::vector<Unit> all = units.of(level);
    const auto given = [&](Unit unit) { return maps->items.contains(name_of_map(unit)); };
    const bool any_here = std::ranges::any_of(all, given);
    auto& of_level = *(files[level] = std::make_shared<std::vector<std::vector<File>>>(units.slots(level)));
    for (const Unit unit : all)
      if (any_here) of_level[unit.index].push_back(file_of(name_of_map(unit), item_of(units, unit).file));
    for (const Unit unit : all)
      if (units.family_of(unit) == units.family_of(all.front())) example = maps->place(name_of_map(unit));
    any |= any_here;
  }
  if (!any)
    throw ConfigError(fmt::format("--maps {}: has no map of any item of the run; expected are such as {}",
                                  maps->source.string(), example));
  return files;
}

}  // namespace salbench
