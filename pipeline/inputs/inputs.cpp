// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/inputs/inputs.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "io/file.h"
#include "io/hdf5/one_form.h"
#include "io/shapes/cloud_file.h"
#include "pipeline/config/section.h"
#include "pipeline/inputs/given_truth.h"
#include "stages/core/errors.h"
#include "stages/core/number.h"
#include "stages/core/parallel.h"
#include "stages/scan/scan.h"

namespace salbench {
namespace {

constexpr std::string_view kOfAName = "./";  // precedes an item's name that is also a keyword, as with files

// "3-17"; nullopt if it is not a range of numbers, or an empty one.
std::optional<std::pair<int, int>> as_range(std::string_view text) {
  const std::size_t dash = text.find('-');
  if (dash == std::string_view::npos) return {};
  const auto first = number_in<int>(text.substr(0, dash)), last = number_in<int>(text.substr(dash + 1));
  if (!first || !last || *first > *last) return {};
  return std::pair(*first, *last);
}

std::string in_short(const std::vector<std::string>& names) {
  constexpr std::size_t kShown = 5;
  if (names.empty()) return "[]";
  const std::size_t shown = std::min(names.size(), kShown);
  const std::string text = fmt::format("{}", fmt::join(names.begin(), names.begin() + shown, ", "));
  return shown == names.size() ? text : fmt::format("{} and {} more", text, names.size() - shown);
}

// A number range takes the items that exist in it, since data sets have gaps. A single name must exist.
std::set<std::string> selected_names(const ItemChoice& choice, const std::set<std::string>& present,
                                     const std::set<std::string>& scored) {
  std::set<std::string> names;
  for (std::string part : choice.parts) {
    const bool is_word = part == kScoredItems && !choice.are_names;
    if (!choice.are_names && part.starts_with(kOfAName)) part.erase(0, kOfAName.size());
    if (present.contains(part) && !is_word) {
      names.insert(part);
      continue;
    }
    if (is_word) {
      if (scored.empty()) throw ConfigError(as_option("items", choice.text) + ": no item has ground truth");
      names.insert(scored.begin(), scored.end());
      continue;
    }
    const auto range = choice.are_names ? std::nullopt : as_range(part);
    if (!range) {
      const std::string hint = did_you_mean(part, {present.begin(), present.end()});
      throw UnknownNameError(fmt::format("{}: the data set has no item '{}'{}{}",
                                         as_option("items", choice.text), part, hint.empty() ? "" : "; ",
                                         hint));
    }
    const std::size_t before = names.size();
    for (const std::string& name : present)
      if (const auto number = number_in<int>(name);
          number && range->first <= *number && *number <= range->second)
        names.insert(name);
    if (names.size() == before)
      throw ConfigError(
          fmt::format("{}: the data set has no item in the range {}", as_option("items", choice.text), part));
  }
  return names;
}

// Names in "train+test", for an item in both.
std::vector<std::string_view> splits_in(std::string_view text) {
  std::vector<std::string_view> names;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('+'), text.size());
    names.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return names;
}

std::set<std::string> names_of_splits(const Dataset& dataset) {
  std::set<std::string> names;
  for (const Item& item : dataset.items)
    for (const std::string_view name : splits_in(item.split)) names.emplace(name);
  return names;
}

void require_split(const Dataset& dataset, const std::string& split) {
  const std::vector<Item>& items = dataset.items;
  const std::set<std::string> known = names_of_splits(dataset);
  if (known.empty())
    throw UnknownNameError(
        fmt::format("split '{}': the data set has no splits{}", split,
                    dataset.no_splits.empty() ? "; they are fields of its items" : "; " + dataset.no_splits));
  if (std::ranges::none_of(items, [&](const auto& item) { return is_in_split(item.split, split); })) {
    const std::string hint = did_you_mean(split, std::vector<std::string_view>(known.begin(), known.end()));
    throw UnknownNameError(fmt::format("split '{}': the data set has no such split; {}{}it has {} ({})",
                                       split, hint, hint.empty() ? "" : " ", fmt::join(known, ", "),
                                       dataset.splits_where));
  }
}

// An item in two splits counts in either, where it then fails with the reason.
bool counts_in_split(const Item& item, const std::string& split) {
  return split.empty() || is_in_split(item.split, split) || !item.problem.empty();
}

// Names of the chosen items, of one split if `split` is set. Throws ConfigError.
std::set<std::string> chosen_items(const Dataset& dataset, const ItemChoice& choice,
                                   const std::string& split) {
  std::set<std::string> names, chosen;
  if (!choice.all()) {
    std::set<std::string> present, scored;
    for (const Item& item : dataset.items) {
      present.insert({item.name, item.shape_name()});
      if (item.has_truth()) scored.insert(item.name);
    }
    names = selected_names(choice, present, scored);
    if (names.empty()) throw ConfigError(as_option("items", choice.text) + ": names no item");
  }
  if (!split.empty()) require_split(dataset, split);
  for (const Item& item : dataset.items)
    if (counts_in_split(item, split) &&
        (choice.all() || names.contains(item.name) || names.contains(item.shape_name())))
      chosen.insert(item.name);
  if (chosen.empty())
    throw ConfigError(
        fmt::format("{}: none of them is in the split '{}'", as_option("items", choice.text), split));
  return chosen;
}

// Note of the data set on unknown names in its splits.
std::string text_of_unknown(const std::vector<SplitEntry>& unknown) {
  std::set<std::string_view> names;
  for (const SplitEntry& entry : unknown) names.insert(entry.item);
  const SplitEntry& first = unknown.front();
  return fmt::format(
      "{}: the split '{}' names '{}', which is no item of the data set{}: correct the name, or "
      "add its files",
      first.where, first.split, first.item,
      names.size() == 1 ? "" : fmt::format(" ({} such names)", names.size()));
}

// Names in splits that are not items: an error in the split asked for, a note elsewhere.
std::vector<std::string> errors_of_split(Dataset& dataset, const std::string& split) {
  std::vector<SplitEntry> of_split, of_others;
  for (const SplitEntry& entry : dataset.unknown)
    (is_in_split(entry.split, split) ? of_split : of_others).push_back(entry);
  if (split.empty() || of_split.empty()) return {};
  std::erase(dataset.notes, text_of_unknown(dataset.unknown));
  if (!of_others.empty()) dataset.notes.push_back(text_of_unknown(of_others));
  return {text_of_unknown(of_split)};
}

// Rejects another item's file before the cache is searched for results of the same bytes, which may be right
// for that item.
std::shared_ptr<const ReadFile> reader_of_form(const Item& item) {
  return std::make_shared<const ReadFile>([path = item.file, name = item.shape_name()]() -> FileData {
    std::string bytes = read_file(path, kMaxItemBytes);
    require_form_of(name, bytes, path);
    return {file_digest(bytes), std::move(bytes)};
  });
}

// Keys contain the numbers of the files. An item without files has one without content, since a unit without
// files has no shape.
std::vector<File> files_of_front(const Item& item) {
  if (item.files.empty()) return {nothing_to_read("no file", item.name)};
  std::vector<File> files;
  for (const std::string& path : item.files)
    files.push_back({.name = fmt::format("file {}", files.size()), .place = path});
  return files;
}

// Level of an item, as listed or by its file's name, or by content if that decides; and the files of its
// shape.
std::pair<Level, std::vector<File>> shape_files_of(const Item& item) {
  if (item.read_by == ReadBy::front) return {item.is_cloud ? kClouds : kMeshes, files_of_front(item)};
  File file{.name = {}, .place = item.file};
  const std::string extension = lower_case_extension(item.file);
  std::string bytes;
  try {
    if (extension == ".ply") bytes = file.read().text();
  } catch (const InputError&) {  // reported by the job that reads it
  }
  const bool is_cloud = holds_cloud(item, bytes);
  file.name = fmt::format("{} file {}", is_cloud ? "point cloud" : "mesh", extension);
  if (item.is_in_form()) file.read_with = reader_of_form(item);
  return {is_cloud ? kClouds : kMeshes, {std::move(file)}};
}

// xxh128sum of the lines "ITEM,SPLIT" in byte order, over all items in a split; independent of where splits
// are stored. Empty if there are none.
std::string digest_of_splits(const Dataset& dataset) {
  std::vector<std::string> lines;
  for (const Item& item : dataset.items)
    if (!item.split.empty()) lines.push_back(fmt::format("{},{}\n", item.name, item.split));
  std::ranges::sort(lines);
  return lines.empty() ? "" : xxh128(fmt::format("{}", fmt::join(lines, ""))).hex();
}

}  // namespace

bool is_in_split(std::string_view text, std::string_view split) {
  return text == split || std::ranges::count(splits_in(text), split) > 0;
}

const std::vector<LevelInfo>& levels() {
  static const std::vector<LevelInfo> levels = {
      {.unit = "set", .units = "data set"},
      {.unit = "mesh", .units = shapes_name(kMeshes)},
      {.unit = "scan", .units = shapes_name(kScans), .head = kMeshes, .parts = kViews, .place = "view"},
      {.unit = "cloud", .units = shapes_name(kClouds)}};
  return levels;
}

bool holds_cloud(const Item& item, std::string_view bytes) {
  return item.read_by == ReadBy::salbench ? is_point_cloud(bytes, item.file) : item.is_cloud;
}

const Item& item_of(const std::any& source) { return std::any_cast<const Item&>(source); }

bool Inputs::has(Level level) const {
  const auto& families = units.families();
  return families.empty() ? level != kClouds : std::ranges::any_of(families, [&](const Family& family) {
    return family.chosen && units.is_above(family.level, level);
  });
}

bool Inputs::has_others() const {
  return !std::ranges::all_of(units.families(), [](const Family& family) { return family.chosen; });
}

File nothing_to_read(std::string name, std::string place) {
  auto read = []() -> FileData { return {file_digest(""), std::string()}; };
  return {.name = std::move(name),
          .place = std::move(place),
          .read_with = std::make_shared<const ReadFile>(read)};
}

File failing_file(std::string name, std::string place, std::string why) {
  auto fail = [why = std::move(why)]() -> FileData { throw InputError(why); };
  return {.name = std::move(name),
          .place = std::move(place),
          .read_with = std::make_shared<const ReadFile>(std::move(fail))};
}

std::string Inputs::text() const {
  const auto several = [](std::size_t n, std::string_view one, std::string_view more) {
    return fmt::format("{} {}", n, n == 1 ? one : more);
  };
  std::vector<std::string> parts;
  const auto add = [&](Level level, std::string_view one, std::string_view more) {
    std::set<std::string_view> shapes;
    bool are_views = false;
    for (const Unit unit : units.of(level)) {
      const Item& item = item_of(units, unit);
      shapes.insert(item.shape_name());
      are_views |= !item.shape.empty();
    }
    if (shapes.empty()) return;
    const std::string views = are_views ? several(count(level), "view", "views") + " of " : "";
    parts.push_back(views + several(shapes.size(), one, more));
  };
  add(kMeshes, "mesh", "meshes");
  add(kClouds, "point cloud", "point clouds");
  return parts.empty() ? "0 meshes" : fmt::format("{}", fmt::join(parts, ", "));
}

DataIdentity identity_of(const Inputs& inputs) {
  DataIdentity identity;
  Hasher hasher;
  for (std::size_t family = 0; family < inputs.units.families().size(); ++family) {
    if (!inputs.units.families()[family].chosen) continue;
    hasher.add(inputs.units.families()[family].name);
    if (inputs.read) hasher.add(item_of(inputs.units.families()[family].source).key);
    for (const FilesOfUnits& files : {inputs.shape_files, inputs.truth_files})
      for (File& file : (*files)[family]) {
        if (inputs.read && files == inputs.truth_files) continue;  // already among the shape's files
        const auto digest = file.digest();
        hasher.add(file.name);
        hasher.add(digest ? digest->hex() : "unreadable");
        ++identity.files;
      }
  }
  identity.digest = hasher.digest();
  return identity;
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

ItemChoice::ItemChoice(const std::string& list) : text(list), parts(split_list(list)) {}

ItemChoice::ItemChoice(std::vector<std::string> names)
    : text(in_short(names)), parts(std::move(names)), are_names(true) {}

void select_items(Dataset& dataset, const ItemChoice& choice, const std::string& split) {
  const std::set<std::string> chosen = chosen_items(dataset, choice, split);
  std::erase_if(dataset.items, [&](const Item& item) { return !chosen.contains(item.name); });
}

namespace {

Recordings recordings_of(const Dataset& dataset) {
  if (std::ranges::none_of(dataset.items, &Item::is_recorded)) return Recordings::none;
  const bool alone = std::ranges::all_of(dataset.items, [](const Item& item) {
    return !item.with_truth && item.saliency.empty() && item.picks.empty();
  });
  return alone ? Recordings::alone : Recordings::some;
}

}  // namespace

Inputs read_inputs(Dataset dataset, const ItemChoice& choice, const std::optional<Shard>& shard,
                   const std::string& split, Others others) {
  std::vector<std::string> errors;
  if (choice.all() || choice.is_scored()) errors = errors_of_split(dataset, split);
  std::string splits = digest_of_splits(dataset);
  std::set<std::string> split_names = names_of_splits(dataset);
  const Recordings recordings = recordings_of(dataset);
  const std::set<std::string> chosen = chosen_items(dataset, choice, split);
  const auto stays = [&](const Item& item) {
    if (chosen.contains(item.name)) return true;
    return !shard && counts_in_split(item, split) &&
           (others == Others::simulated || (others == Others::measured && item.has_truth()));
  };
  std::vector<Item> items = std::move(dataset.items);
  std::erase_if(items, [&](const Item& item) { return !stays(item); });
  if (shard) items = share_of(std::move(items), *shard);
  std::vector<Family> families(items.size());
  std::vector<std::vector<File>> shapes(items.size()), truths(items.size());
  parallel_ranges(items.size(), 1, [&](std::size_t i, std::size_t) {
    auto [level, files] = shape_files_of(items[i]);
    shapes[i] = std::move(files);
    truths[i] = truth_files_of(items[i]);
    families[i] = {level, items[i].name, {}, chosen.contains(items[i].name)};
    families[i].source = std::move(items[i]);
  });
  return {.layout = dataset.layout,
          .notes = dataset.notes,
          .errors = std::move(errors),
          .units = Units(levels(), std::move(families)),
          .shape_files = std::make_shared<std::vector<std::vector<File>>>(std::move(shapes)),
          .truth_files = std::make_shared<std::vector<std::vector<File>>>(std::move(truths)),
          .read = dataset.read,
          .version = dataset.version,
          .shard = shard,
          .remark = dataset.remark,
          .splits = std::move(splits),
          .recordings = recordings,
          .split_names = std::move(split_names)};
}

}  // namespace salbench
