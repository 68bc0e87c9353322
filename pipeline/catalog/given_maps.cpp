// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/catalog/given_maps.h"

#include <cmath>

#include <fmt/format.h>

#include "io/file.h"
#include "io/ground_truth_file.h"
#include "io/hdf5_file.h"
#include "io/text_scanner.h"
#include "pipeline/catalog/model_name.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

void check_name(std::string_view name) {
  if (const std::string wrong = wrong_with_model_name(name); !wrong.empty())
    throw ConfigError(fmt::format("--name {}: {}", in_quotes(name), wrong));
}

bool is_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

GivenMaps maps_in_folder(const fs::path& folder) {
  GivenMaps maps{.source = folder};
  for (const FolderEntry& entry : list_folder(folder))
    if (entry.path.extension() == ".val") maps.items.insert(entry.path.stem().string());
  maps.read = [folder](const std::string& item) -> SourceData {
    std::string text = read_file(folder / (item + ".val"), kMaxItemBytes);
    return {file_digest(text), std::move(text)};
  };
  return maps;
}

// Maps are told apart by their own values, so that a file with a map more leaves the others as they are.
GivenMaps maps_in_file(const fs::path& path) try {
  const auto file = std::make_shared<const Hdf5File>(path);
  GivenMaps maps{.source = path};
  for (const std::string& name : file->arrays()) maps.items.insert(name);
  maps.read = [file, path](const std::string& item) -> SourceData {
    const Array array = file->read(item);
    try {
      return {content_digest({array}), point_values(array)};
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: data set {}: {}", path.string(), in_quotes(item), error.what()));
    }
  };
  return maps;
} catch (const InputError& error) {
  throw ConfigError(fmt::format("--maps {}", error.what()));
}

}  // namespace

std::string GivenMaps::place(const std::string& item) const {
  return is_folder(source) ? (source / (item + ".val")).string()
                           : fmt::format("{}: data set {}", source.string(), item);
}

ScalarField GivenMaps::checked(const SourceData& data, const std::string& item, std::size_t n_points,
                               const PointCloud* cloud) const {
  const std::string where = place(item);
  const auto* values = std::get_if<ScalarField>(&data.content);
  ScalarField map = values != nullptr ? *values : parse_values(data.text(), where);
  if (cloud != nullptr && map.size() == cloud->size_in_file()) map = values_left(*cloud, map);
  if (map.size() != n_points)
    throw InputError(fmt::format("{}: {} values, but the shape has {} points", where, map.size(), n_points));
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (!std::isfinite(map[i]))
      throw InputError(
          fmt::format("{}: value {} (0-based) is {}, expected a finite number", where, i, map[i]));
    if (matched && !(map[i] >= 0 && map[i] <= 1))
      throw InputError(
          fmt::format("{}: value {} (0-based) is {}: a matched map lies in [0, 1]; leave out "
                      "--matched to have it matched",
                      where, i, map[i]));
  }
  return map;
}

GivenMaps find_given_maps(const fs::path& source, bool matched) {
  GivenMaps maps = is_folder(source) ? maps_in_folder(source) : maps_in_file(source);
  maps.matched = matched;
  return maps;
}

Model given_model(const std::string& name, GivenMaps maps) {
  check_name(name);
  return {.name = name, .version = 1, .given = std::make_shared<const GivenMaps>(std::move(maps))};
}

}  // namespace salbench
