// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/plan/workload.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <set>

#include <fmt/format.h>

#include "io/cloud_file.h"
#include "io/file.h"
#include "pipeline/catalog/given_maps.h"
#include "pipeline/catalog/given_truth.h"
#include "stages/core/errors.h"
#include "stages/core/parallel.h"

namespace salbench {
namespace {

std::optional<int> as_number(std::string_view text) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (text.empty() || error != std::errc() || end != text.data() + text.size()) return {};
  return number;
}

struct Range {
  int first = 0, last = 0;
};

// "3-17"; nothing where it is no range of numbers, or an empty one.
std::optional<Range> as_range(std::string_view text) {
  const std::size_t dash = text.find('-');
  if (dash == std::string_view::npos) return {};
  const auto first = as_number(text.substr(0, dash)), last = as_number(text.substr(dash + 1));
  if (!first || !last || *first > *last) return {};
  return Range{*first, *last};
}

// A number range takes the items that exist in it: data sets have gaps. A single name must exist.
std::set<std::string> selected_names(const std::string& selection, const std::set<std::string>& present) {
  std::set<std::string> names;
  for (const std::string& part : split_list(selection)) {
    if (present.contains(part)) {
      names.insert(part);
      continue;
    }
    const std::optional<Range> range = as_range(part);
    if (!range) throw ConfigError(fmt::format("--items {}: the data set has no item '{}'", selection, part));
    const std::size_t before = names.size();
    for (const std::string& name : present)
      if (const auto number = as_number(name); number && range->first <= *number && *number <= range->last)
        names.insert(name);
    if (names.size() == before)
      throw ConfigError(fmt::format("--items {}: the data set has no item in the range {}", selection, part));
  }
  return names;
}

Family make_family(const DatasetItem& source) {
  SourceData data;
  SourceFile file = mesh_file_of(source, &data);
  Family family{source, {}, truth_files_of(source)};
  family.is_cloud = is_point_cloud(data.text(), source.mesh);
  if (family.is_cloud) file.name = "point cloud file " + lower_case_extension(source.mesh);
  family.shape_file.push_back(std::move(file));
  return family;
}

SourceFile map_file(const std::shared_ptr<const GivenMaps>& maps, const std::string& item) {
  std::string place = maps->place(item);
  return source_file("map file", place, [maps, item, place] {
    if (!maps->items.contains(item))
      throw InputError(fmt::format("{}: missing, although other items have a map", place));
    return maps->read(item);
  });
}

// Names of the items that one family may have, [Item::in_family()].
std::vector<std::string> names_of(const Family& family) {
  std::vector<std::string> names = {family.source.name};
  for (int view = 0; view < kViews && !family.is_cloud; ++view)
    names.push_back(fmt::format("{}_{}", names[0], view));
  return names;
}

Shapes kind_of_name(const Family& family, std::size_t in_family) {
  return in_family > 0 ? Shapes::scans : family.shapes();
}

}  // namespace

DataIdentity identity_of(const Workload& workload) {
  DataIdentity identity;
  Hasher hasher;
  for (const Family& family : workload.families) {
    hasher.add(family.source.name);
    for (const SourceFiles* files : {&family.shape_file, &family.truth_files})
      for (const SourceFile& file : *files) {
        hasher.add(file.name);
        hasher.add(file.digest ? file.digest->hex() : "unreadable");
        ++identity.files;
      }
  }
  identity.digest = hasher.digest();
  return identity;
}

std::size_t count_clouds(const Workload& workload) {
  return static_cast<std::size_t>(std::count_if(workload.families.begin(), workload.families.end(),
                                                [](const Family& family) { return family.is_cloud; }));
}

std::string shapes_text(const Workload& workload) {
  const std::size_t clouds = count_clouds(workload), meshes = workload.families.size() - clouds;
  if (clouds == 0) return fmt::format("{} meshes", meshes);
  return fmt::format("{}{} point clouds", meshes > 0 ? fmt::format("{} meshes, ", meshes) : "", clouds);
}

DataKinds kinds_of(const Workload& workload) {
  const std::size_t clouds = count_clouds(workload);
  const bool any_mesh = clouds<workload.families.size(), any_cloud = clouds> 0;
  return {.meshes = any_mesh, .clouds = any_cloud};
}

std::vector<std::string> split_list(const std::string& list) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  while (begin <= list.size()) {
    const std::size_t comma = std::min(list.find(',', begin), list.size());
    std::string part = list.substr(begin, comma - begin);
    part.erase(0, part.find_first_not_of(' '));
    part.erase(part.find_last_not_of(' ') + 1);
    if (!part.empty()) parts.push_back(part);
    begin = comma + 1;
  }
  return parts;
}

Workload make_workload(const Dataset& dataset, const std::string& selection,
                       const std::optional<Shard>& shard) {
  std::set<std::string> present;
  for (const DatasetItem& item : dataset.items) present.insert(item.name);
  const std::set<std::string> names = selection.empty() ? present : selected_names(selection, present);
  if (names.empty()) throw ConfigError(fmt::format("--items {}: names no item", selection));

  std::vector<DatasetItem> items = dataset.items;
  std::erase_if(items, [&](const DatasetItem& item) { return !names.contains(item.name); });
  Workload workload{dataset.layout, {}, dataset.notes};
  if (shard) items = share_of(items, *shard);
  workload.families.resize(items.size());
  parallel_ranges(items.size(), 1,
                  [&](std::size_t i, std::size_t) { workload.families[i] = make_family(items[i]); });
  return workload;
}

void add_given_maps(Workload& workload, const Catalog& catalog, const Model& model) {
  const GivenMaps& maps = *model.given;
  std::array<bool, EnumNames<Shapes>::names.size()> any{};  // has a map of such shapes that is scored
  std::string example;                                      // of a name that would be one
  for (const Family& family : workload.families) {
    const auto names = names_of(family);
    for (std::size_t i = 0; i < names.size(); ++i) {
      const Shapes kind = kind_of_name(family, i);
      if (!catalog.has(kind, "scores." + model.name)) continue;
      any[static_cast<std::size_t>(kind)] |= maps.items.contains(names[i]);
      if (&family == &workload.families.front()) example = maps.place(names[i]);
    }
  }
  if (std::none_of(any.begin(), any.end(), [](bool one) { return one; }))
    throw ConfigError(fmt::format("--maps {}: has no map of any item of the run; expected are such as {}",
                                  maps.source.string(), example));
  for (Family& family : workload.families) {
    const auto names = names_of(family);
    for (std::size_t i = 0; i < names.size(); ++i) {
      family.map_files.emplace_back();
      if (any[static_cast<std::size_t>(kind_of_name(family, i))])
        family.map_files.back().push_back(map_file(model.given, names[i]));
    }
  }
}

}  // namespace salbench
