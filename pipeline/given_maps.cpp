#include "pipeline/given_maps.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "io/file.h"
#include "io/hdf5_file.h"
#include "io/text_scanner.h"
#include "pipeline/plan.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

// In the tables and in the cache the name stands beside others: these mean something else there.
constexpr std::array<std::string_view, 2> kTaken = {"GS", "Avg-AUC"};
constexpr std::size_t kLongestName = 40;

void check_name(std::string_view name) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
  };
  if (name.empty() || name.size() > kLongestName || !std::all_of(name.begin(), name.end(), plain))
    throw ConfigError(fmt::format("--name {}: must be 1 to {} letters, digits, '-' and '_'", in_quotes(name),
                                  kLongestName));
  const auto rows = model_rows();
  if (std::find(kTaken.begin(), kTaken.end(), name) != kTaken.end() ||
      std::any_of(rows.begin(), rows.end(), [&](const ModelRow& row) { return row.name == name; }))
    throw ConfigError(fmt::format("--name {}: is the name of something else in the tables; choose another",
                                  in_quotes(name)));
}

ScalarField read_val(const fs::path& path) {
  const std::string text = read_file(path);
  TextScanner in(text, path.string());
  ScalarField values;
  while (in.next_filled_line()) {
    values.push_back(in.number());
    if (!in.peek_word().empty()) in.fail("the line has more than one value");
  }
  return values;
}

ScalarField as_field(const Array& array) {
  return std::visit([](const auto& values) { return ScalarField(values.begin(), values.end()); },
                    array.values);
}

void check_map(const ScalarField& map, std::size_t n_points, bool matched, const std::string& place) {
  if (map.size() != n_points)
    throw InputError(fmt::format("{}: has {} values, the item {} points: they do not belong together", place,
                                 map.size(), n_points));
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (!std::isfinite(map[i]))
      throw InputError(fmt::format("{}: value {} (from 0) is {}, not a finite number", place, i, map[i]));
    if (matched && !(map[i] >= 0 && map[i] <= 1))
      throw InputError(
          fmt::format("{}: value {} (from 0) is {}: a matched map lies in [0, 1]; leave out "
                      "--matched to have it matched",
                      place, i, map[i]));
  }
}

GivenMaps maps_in_folder(const fs::path& folder) {
  GivenMaps maps{.source = folder};
  std::error_code error;
  for (const auto& file : fs::directory_iterator(folder, error))
    if (file.path().extension() == ".val") maps.items.insert(file.path().stem().string());
  if (error)
    throw ConfigError(fmt::format("--maps {}: cannot be listed: {}", folder.string(), error.message()));
  maps.digest = [folder](const std::string& item) {
    return file_digest(read_file(folder / (item + ".val")));
  };
  maps.read = [folder](const std::string& item, std::size_t) { return read_val(folder / (item + ".val")); };
  return maps;
}

// The file is read once; of two items the maps are told apart by their own values, so that a file with a map
// more leaves the others as they are.
GivenMaps maps_in_file(const fs::path& file) {
  const auto bytes = read_bytes(file);
  if (!bytes) throw ConfigError(fmt::format("--maps {}: cannot be read", file.string()));
  std::shared_ptr<const Arrays> arrays;
  try {
    arrays = std::make_shared<const Arrays>(hdf5_content(*bytes, file.string()).arrays);
  } catch (const InputError& error) {
    throw ConfigError(fmt::format("--maps {}", error.what()));
  }
  GivenMaps maps{.source = file};
  for (const Array& array : *arrays) maps.items.insert(array.name);
  maps.digest = [arrays](const std::string& item) { return content_digest({*find_array(*arrays, item)}); };
  maps.read = [arrays](const std::string& item, std::size_t) { return as_field(*find_array(*arrays, item)); };
  return maps;
}

SourceDigest source_of(const GivenMaps& maps, const std::string& item) {
  constexpr const char* kInKey = "map file";
  if (!maps.items.contains(item))
    return {kInKey, {}, fmt::format("{}: there is none, and of others there is", maps.place(item))};
  try {
    return {kInKey, maps.digest(item), {}};
  } catch (const InputError& error) {
    return {kInKey, {}, error.what()};
  }
}

bool any_given(const Context& context, const Model& model, bool meshes) {
  if (!has_stage(meshes ? context.catalog.mesh : context.catalog.scan, "scores." + model.name)) return false;
  const std::vector<ItemRef> items = context.items(meshes);
  return std::any_of(items.begin(), items.end(),
                     [&](const ItemRef& item) { return model.given->items.contains(context.name(item)); });
}

}  // namespace

std::string GivenMaps::place(const std::string& item) const {
  return fs::is_directory(source) ? (source / (item + ".val")).string()
                                  : fmt::format("{}: data set {}", source.string(), item);
}

GivenMaps find_given_maps(const fs::path& source, bool matched) {
  GivenMaps maps = fs::is_directory(source) ? maps_in_folder(source) : maps_in_file(source);
  maps.matched = matched;
  maps.read = [maps](const std::string& item, std::size_t n_points) {
    ScalarField map = maps.read(item, n_points);
    check_map(map, n_points, maps.matched, maps.place(item));
    return map;
  };
  return maps;
}

Model given_model(const std::string& name, GivenMaps maps) {
  check_name(name);
  return {.name = name, .version = 1, .given = std::make_shared<const GivenMaps>(std::move(maps))};
}

void add_given_maps(Workload& workload, const Context& context, const Model& model) {
  const GivenMaps& maps = *model.given;
  const bool meshes = any_given(context, model, true), scans = any_given(context, model, false);
  if (!meshes && !scans)
    throw ConfigError(fmt::format("--maps {}: has a map of no item of the run; expected are such as {}",
                                  maps.source.string(), maps.place(context.name(context.family(0).back()))));
  for (std::size_t f = 0; f < workload.families.size(); ++f)
    for (const ItemRef& item : context.family(f)) {
      auto& files = workload.families[f].map_files.emplace_back();
      if (item.is_mesh() ? meshes : scans) files.push_back(source_of(maps, context.name(item)));
    }
}

}  // namespace salbench
