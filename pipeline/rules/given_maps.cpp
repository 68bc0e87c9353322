// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/rules/given_maps.h"

#include <cmath>
#include <set>

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

// The map has the digest of its values, so that adding a map to a file of several leaves the others cached.
File map_of_front(const Front& front, const fs::path& path, const std::string& name,
                  const std::string& place) {
  const auto read = [read_map = front.read_map, path, name]() -> FileData {
    ScalarField values = answering<InputError>(read_map, path.string())(path, name);
    return {content_digest({column(name, values, "1", "")}), std::move(values)};
  };
  return {.name = "map file", .place = place, .read_with = std::make_shared<const ReadFile>(read)};
}

// Text, or .npy. Other files may lie beside the maps, and have the name of no item.
GivenMaps maps_in_folder(const fs::path& folder, const Front& front) {
  GivenMaps maps{.source = folder};
  for (const FolderEntry& entry : list_folder(folder)) {
    const std::string extension = lower_case_extension(entry.path), name = entry.path.stem();
    if (extension != ".val" && extension != ".txt" && extension != ".csv" && extension != ".npy") continue;
    const std::string place = entry.path.string();
    const auto [map, is_new] =
        maps.files.try_emplace(name, extension == ".npy" ? map_of_front(front, entry.path, name, place)
                                                         : File{.name = "map file", .place = place});
    if (is_new) continue;
    if (lower_case_extension(map->second.place) == extension)
      throw ConfigError(
          fmt::format("--maps {} and {} differ by case alone: keep one of them", map->second.place, place));
    const std::string other = map->second.place;
    if (extension == ".val")  // the other file is another form of it
      map->second = {.name = "map file", .place = place};
    else if (lower_case_extension(other) != ".val")
      map->second = failing_file("map file", place, fmt::format("{} and {}: keep one of them", other, place));
  }
  return maps;
}

GivenMaps maps_in_file(const fs::path& path, const Front& front) try {
  GivenMaps maps{.source = path};
  for (const std::string& name : answering(front.names_of_maps, "a file of maps")(path))
    maps.files[name] = map_of_front(front, path, name, maps.place(name));
  return maps;
} catch (const InputError& error) {
  throw ConfigError(fmt::format("--maps {}", error.what()));
}

ScalarField values_in(const FileData& data, const std::string& where) {
  const auto* values = std::get_if<ScalarField>(&data.content);
  return values != nullptr ? *values : parse_values(data.text(), where);
}

// Faults of the map or the mesh are reported where they are used.
FileData of_triangles(FileData data, const std::string& item, const std::string& mesh_file) try {
  if (!has_mesh_extension(mesh_file)) return data;
  PolygonCounts counts;
  const Mesh mesh = parse_mesh(read_file(mesh_file, kMaxItemBytes), mesh_file, &counts);
  if (counts.split == 0) return data;
  const ScalarField of_faces = values_in(data, item);
  const bool of_vertices = of_faces.size() == mesh.vertices.size();  // also if both counts match
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
  if (const auto file = files.find(item); file != files.end()) return file->second.place;
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
  GivenMaps maps = is_folder(source) ? maps_in_folder(source, front) : maps_in_file(source, front);
  maps.matched = matched;
  return maps;
}

std::map<Level, FilesOfUnits> map_files(const GivenMaps& maps, const Units& units,
                                        const std::vector<Level>& levels, bool on_faces) {
  // Separately scored views of a shape may share its map.
  const auto name_of_map = [&](Unit unit) {
    const std::string name = units.name(unit);
    const Item& item = item_of(units, unit);
    return item.view.empty() || maps.files.contains(name) ? name
                                                          : item.shape_name() + name.substr(item.name.size());
  };
  const auto is_given = [&](Unit unit) { return maps.files.contains(name_of_map(unit)); };
  const auto file_of = [&](Unit unit) -> File {
    const std::string name = name_of_map(unit);
    const std::string place = maps.place(name);
    if (!is_given(unit))
      return failing_file("map file", place, place + ": missing, although other items have a map");
    if (!on_faces) return maps.files.at(name);
    const auto read = [file = maps.files.at(name), name, mesh = item_of(units, unit).file]() mutable {
      return of_triangles(file.read(), name, mesh);
    };
    return {.name = "map file", .place = place, .read_with = std::make_shared<const ReadFile>(read)};
  };
  std::map<Level, FilesOfUnits> files;
  std::string example;  // example of an expected file name
  std::set<std::string> names;
  bool any = false;
  for (const Level level : levels) {
    const std::vector<Unit> all = units.of(level);
    const bool any_here = std::ranges::any_of(all, is_given);
    auto& of_level = *(files[level] = std::make_shared<std::vector<std::vector<File>>>(units.slots(level)));
    for (const Unit unit : all) {
      if (is_given(unit) && !names.insert(units.name(unit)).second)
        throw ConfigError(fmt::format(
            "--maps {}: two shapes are called {}, one of them a scan: rename the other, or set scans: false",
            maps.place(name_of_map(unit)), units.name(unit)));
      if (any_here) of_level[unit.index].push_back(file_of(unit));
      if (units.family_of(unit) == units.family_of(all.front())) example = maps.place(name_of_map(unit));
    }
    any |= any_here;
  }
  if (!any)
    throw ConfigError(fmt::format("--maps {}: has no map of any item of the run; expected are such as {}",
                                  maps.source.string(), example));
  return files;
}

}  // namespace salbench
