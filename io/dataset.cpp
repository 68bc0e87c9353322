// SPDX-License-Identifier: GPL-3.0-or-later
// A layout is a list of places: where the meshes may lie and, for each, where their ground truth may. The
// first place with a mesh is taken, so the result depends on the names in the folders alone.

#include "io/dataset.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <optional>
#include <ranges>
#include <set>

#include <fmt/format.h>

#include "io/cloud_file.h"
#include "io/file.h"
#include "io/mesh_file.h"
#include "io/one_form_index.h"
#include "io/text_scanner.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

// The tracks of SHREC'07 in the order of their meshes, twenty each. [giorgi2007]
constexpr std::array<std::string_view, 20> kCategories = {
    "human",     "cup",   "glasses",  "airplane", "ant",  "chair",      "octopus",
    "table",     "teddy", "hand",     "plier",    "fish", "bird",       "spring",
    "armadillo", "buste", "mechanic", "bearing",  "vase", "four-legged"};
constexpr int kMeshesPerCategory = 20;
constexpr int kBenchmarkMeshes = static_cast<int>(kCategories.size()) * kMeshesPerCategory;

struct NaturalLess {
  using is_transparent = void;
  bool operator()(std::string_view a, std::string_view b) const { return natural_less(a, b); }
};

struct Found {
  const Layout& layout;
  const Place& place;
  std::vector<fs::path> meshes;
};

bool is_open(const Place& place, const fs::path& root) {
  return (place.needs.empty() || is_folder(root / place.needs)) &&
         (place.root_is.empty() || root.filename() == place.root_is);
}

bool is_in(Domain domain, const TruthFormat& format, const fs::path& file) {
  if (is_column_cloud(file, format.columns)) return domain != Domain::meshes;
  if (domain == Domain::any) return has_shape_extension(file);
  return domain == Domain::meshes ? has_mesh_extension(file) : has_cloud_extension(file);
}

std::optional<Found> find_layout(const fs::path& root, const Layout& layout) {
  for (const Place& place : layout.places) {
    if (!is_open(place, root)) continue;
    std::vector<fs::path> meshes;
    for (FoundFile& file : files_like(root, place.meshes, {}).fit)
      if (is_in(layout.domain, layout.format, file.path)) meshes.push_back(std::move(file.path));
    if (!meshes.empty()) return Found{layout, place, std::move(meshes)};
  }
  return {};
}

// "/data/Meshes, /data/off"; of a user's own description with its lines: "/data/off/*.off (own.yaml:3)".
std::string where_looked_for(const fs::path& root, const Layout& layout) {
  std::set<std::string> places, needs, names;
  for (const Place& place : layout.places) {
    if (is_open(place, root))
      places.insert(layout.needs_truth
                        ? fmt::format("{} ({})", place_of(root, place.meshes), place.meshes.where)
                        : place_of(root, place.meshes));
    else if (!place.needs.empty())
      needs.insert(place.needs + "/");
    else
      names.insert(place.root_is);
  }
  if (!places.empty()) return fmt::format("{}", fmt::join(places, ", "));
  if (needs.empty()) return fmt::format("{} (is not named {})", root.string(), fmt::join(names, " or "));
  return fmt::format("{} ({} {} in it)", root.string(), needs.size() == 1 ? "without" : "with neither",
                     fmt::join(needs, " nor "));
}

Found find_meshes(const fs::path& root, std::span<const Layout> layouts) {
  if (!is_folder(root)) throw InputError(fmt::format("{}: there is no such folder", root.string()));
  std::vector<std::string> searched;
  for (const Layout& layout : layouts) {
    if (const auto found = find_layout(root, layout)) return *found;
    searched.push_back(fmt::format("{}: {}", layout.name, where_looked_for(root, layout)));
  }
  throw InputError(fmt::format(
      "{}: no .off, .obj or .ply meshes found, and no .ply, .pcd or .xyz point clouds; looked in {}",
      root.string(), fmt::join(searched, "; ")));
}

// 1..400, or 0 for a name that is not such a number.
int benchmark_number(const std::string& name) {
  if (name.empty() || name.size() > 3 || name[0] == '0' || !is_digits(name)) return 0;
  const int number = std::stoi(name);
  return number <= kBenchmarkMeshes ? number : 0;
}

using ItemsByName = std::map<std::string, DatasetItem, NaturalLess>;

std::string category_of(const fs::path& mesh, Classes classes) {
  if (classes == Classes::folder) return mesh.parent_path().filename();
  const int number = classes == Classes::shrec07 ? benchmark_number(mesh.stem()) : 0;
  return number == 0 ? std::string()
                     : std::string(kCategories[static_cast<std::size_t>((number - 1) / kMeshesPerCategory)]);
}

ItemsByName items_of(const Found& found, Twins twins, std::vector<std::string>& notes) {
  const auto format = std::make_shared<const TruthFormat>(found.layout.format);
  std::vector<NamedFile> files;
  for (const fs::path& mesh : found.meshes) files.push_back({mesh.stem(), mesh});
  ItemsByName items;
  for (const auto& [name, mesh] : without_twins(files, twins, notes))
    items.emplace(name, DatasetItem{.name = name,
                                    .category = category_of(mesh, found.layout.classes),
                                    .mesh = mesh,
                                    .saliency = {},
                                    .picks = {},
                                    .format = format});
  return items;
}

using Files = std::vector<std::string> DatasetItem::*;

// Adds the files of one pattern to their items, and notes those that belong to none.
class TruthFinder {
 public:
  TruthFinder(const fs::path& root, ItemsByName& items, std::vector<std::string>& notes)
      : root_(root), items_(items), notes_(notes) {}

  // How many files there are of items.
  std::size_t add(const FilePattern& pattern, Files files) {
    const FoundFiles found =
        files_like(root_, pattern, [&](std::string_view name) { return items_.contains(name); });
    std::size_t added = 0;
    for (const FoundFile& file : found.fit) {
      const auto item = items_.find(file.item);
      if (item == items_.end()) {
        without_mesh_.emplace(file.item, file.path);
        continue;
      }
      std::vector<std::string>& of_item = item->second.*files;
      if (one_file_per_item(pattern) && !of_item.empty())
        throw InputError(fmt::format("{}: {} has a file already, {}, and {} means one: keep one of them",
                                     file.path.string(), file.item, of_item[0], pattern.where));
      of_item.push_back(file.path);
      if (files == &DatasetItem::saliency && !one_file_per_item(pattern))
        item->second.views.push_back(file.part);
      ++added;
    }
    for (const fs::path& file : found.left_out)
      notes_.push_back(
          fmt::format("{}: is not named {} and was left out", file.string(), expected_name(pattern)));
    return added;
  }

  void note_files_without_mesh() {
    for (const auto& [name, file] : without_mesh_)
      notes_.push_back(fmt::format("{}: ground truth without a mesh or point cloud ({})", name, file));
  }

 private:
  const fs::path& root_;
  ItemsByName& items_;
  std::vector<std::string>& notes_;
  std::map<std::string, std::string, NaturalLess> without_mesh_;  // name -> one of its files
};

// A view without ground truth, which fails.
void add_view_without_truth(DatasetItem& item, const std::string& view, const std::string& mask,
                            const std::string& expected, const std::string& where) {
  item.saliency.emplace_back();
  item.views.push_back(view);
  item.masks.push_back(
      {mask,
       fmt::format("{}: is missing, the ground truth of the view that {} is the mask of: add it, or take "
                   "the mask away ({})",
                   expected, mask, where)});
}

// Gives each saliency file its mask. One that is missing is its item's failure.
void add_masks(const fs::path& root, const Place& place, const TruthPlace& truth, ItemsByName& items,
               std::vector<std::string>& notes) {
  const FilePattern& pattern = truth.mask;
  if (pattern.empty()) return;
  std::map<std::pair<std::string, std::string>, std::string> masks;  // (item, view) -> file
  for (const FoundFile& file :
       files_like(root, pattern, [&](std::string_view name) { return items.contains(name); }).fit)
    masks.emplace(std::pair(file.item, file.part), file.path);
  const bool one = one_file_per_item(pattern);
  std::set<std::string> used;
  for (auto& [name, item] : items)
    for (std::size_t k = 0; k < item.saliency.size(); ++k) {
      const std::string view = one ? std::string() : item.views[k];
      const auto found = masks.find({name, view});
      if (found != masks.end()) {
        used.insert(found->second);
        item.masks.push_back({found->second});
        continue;
      }
      const std::string path = (root / filled_in(pattern, name, view)).lexically_normal();
      item.masks.push_back(
          {path, fmt::format("{}: is missing, the mask of {}: add it, or take its ground truth away ({})",
                             path, item.saliency[k], pattern.where)});
    }
  for (const auto& [key, file] : masks) {
    if (used.contains(file)) continue;
    const auto item = items.find(key.first);
    if (place.views == Views::scored && item != items.end() && !item->second.saliency.empty())
      add_view_without_truth(item->second, key.second, file,
                             (root / filled_in(truth.saliency, key.first, key.second)).lexically_normal(),
                             truth.saliency.where);
    else
      notes.push_back(fmt::format("{}: mask without ground truth", file));
  }
}

// Gives each saliency file the camera of its view. One that is missing is its item's failure.
void add_cameras(const FoundCameras& found, const Cameras& cameras, DatasetItem& item) {
  const std::vector<std::string> views = item.views.empty() ? std::vector<std::string>(1) : item.views;
  for (const std::string& view : views) {
    if (const ItemCamera* camera = found.find(item.shape_name(), view)) {
      item.cameras.push_back(*camera);
      continue;
    }
    item.cameras.clear();
    if (item.problem.empty())
      item.problem = fmt::format("{}: there is no camera of {}{}: add it", cameras.where, item.shape_name(),
                                 view.empty() ? "" : fmt::format(" for the view '{}'", view));
    return;
  }
}

// An item for each view, in the order of their files.
std::vector<DatasetItem> items_of_views(const DatasetItem& item) {
  std::vector<DatasetItem> views;
  for (std::size_t k = 0; k < item.saliency.size(); ++k) {
    DatasetItem& view = views.emplace_back(item);
    view.name = item.name + "_" + item.views[k];
    view.shape = item.name;
    view.view = item.views[k];
    view.saliency = {item.saliency[k]};
    view.views = {item.views[k]};
    if (!item.masks.empty()) view.masks = {item.masks[k]};
    if (!item.saliency[k].empty()) continue;
    view.problem = view.masks[0].missing;
    view.saliency.clear();
  }
  return views;
}

// Returns why there are none, if a description has them.
std::string add_splits(const fs::path& root, const DataSplits& splits, ItemsByName& items,
                       std::vector<std::string>& notes, std::vector<SplitEntry>& unknown) {
  if (splits.empty()) return {};
  FoundSplits found = read_splits(root, splits, [&](std::string_view name) { return items.contains(name); });
  if (!found.unknown.empty()) notes.push_back(text_of_unknown(found.unknown));
  unknown = std::move(found.unknown);
  std::vector<std::string_view> in_none;
  for (auto& [name, item] : items) {
    if (const auto split = found.of_item.find(name); split != found.of_item.end()) item.split = split->second;
    if (const auto problem = found.problems.find(name); problem != found.problems.end())
      item.problem = problem->second;
    else if (item.split.empty())
      in_none.push_back(name);
  }
  constexpr std::size_t kMostNamed = 5;
  if (!found.of_item.empty() && !in_none.empty())
    notes.push_back(fmt::format("{} of {} items are in no split ({}): {}{}", in_none.size(), items.size(),
                                splits.where, fmt::join(in_none | std::views::take(kMostNamed), ", "),
                                in_none.size() > kMostNamed ? ", ..." : ""));
  return found.missing;
}

void require_files(const fs::path& root, const FilePattern& pattern, std::size_t found) {
  if (!pattern.empty() && found == 0)
    throw InputError(fmt::format("{}: '{}' fits no file of an item; expected are such as {}", pattern.where,
                                 pattern.text, place_of(root, pattern)));
}

// Returns where the ground truth was found; null if it is nowhere.
const TruthPlace* add_truth(const Found& found, const fs::path& root, ItemsByName& items,
                            std::vector<std::string>& notes) {
  const std::vector<TruthPlace>& places = found.place.truth;
  const auto there = std::find_if(places.begin(), places.end(), [&](const TruthPlace& place) {
    return has_folder_for(root, place.saliency) || has_folder_for(root, place.picks);
  });
  if (there == places.end()) {
    if (found.layout.needs_truth && !places.empty())
      require_files(root, places[0].saliency.empty() ? places[0].picks : places[0].saliency, 0);
    return nullptr;
  }
  TruthFinder finder(root, items, notes);
  for (auto& [name, item] : items) item.by_viewer = has_viewers(there->saliency);
  for (const auto& [pattern, files] :
       {std::pair(there->saliency, &DatasetItem::saliency), std::pair(there->picks, &DatasetItem::picks)}) {
    const std::size_t added = finder.add(pattern, files);
    if (found.layout.needs_truth) require_files(root, pattern, added);
  }
  finder.note_files_without_mesh();
  add_masks(root, found.place, *there, items, notes);
  return &*there;
}

// "261-280, 399"
std::string ranges(const std::vector<int>& ascending) {
  std::vector<std::string> parts;
  for (std::size_t first = 0, last; first < ascending.size(); first = last + 1) {
    last = first;
    while (last + 1 < ascending.size() && ascending[last + 1] == ascending[last] + 1) ++last;
    parts.push_back(first == last ? fmt::format("{}", ascending[first])
                                  : fmt::format("{}-{}", ascending[first], ascending[last]));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

// Notes which meshes of the benchmark are not here; nothing unless all items are meshes of the benchmark.
void note_missing_numbers(const ItemsByName& items, std::vector<std::string>& notes) {
  for (const auto& [name, item] : items)
    if (item.category.empty()) return;
  std::vector<int> missing;
  for (int number = 1; number <= kBenchmarkMeshes; ++number)
    if (!items.contains(std::to_string(number))) missing.push_back(number);
  if (!missing.empty())
    notes.push_back(fmt::format("{} of the {} meshes of SHREC'07 are here, without {}", items.size(),
                                kBenchmarkMeshes, ranges(missing)));
}

}  // namespace

Dataset find_dataset(const fs::path& root, std::span<const Layout> layouts, Twins twins) {
  fs::path folder = root.lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();  // "data/" is "data"
  if (layouts.size() == 1 && !layouts[0].index.empty()) return indexed_dataset(folder, layouts[0]);
  const Found found = find_meshes(folder, layouts);
  Dataset dataset;
  ItemsByName items = items_of(found, twins, dataset.notes);
  dataset.layout = found.layout.name;
  if (found.layout.classes == Classes::shrec07) note_missing_numbers(items, dataset.notes);
  const TruthPlace* truth = add_truth(found, folder, items, dataset.notes);
  const DataSplits& splits = found.layout.splits;
  dataset.no_splits = add_splits(folder, splits, items, dataset.notes, dataset.unknown);
  dataset.splits_where = splits.where;
  dataset.licence = found.layout.licence;
  for (const std::string& file : {splits.table, splits.list})
    if (!file.empty()) dataset.read.push_back((folder / file).lexically_normal());
  for (auto& [name, item] : items) {
    if (found.place.views == Views::scored && !item.views.empty())
      std::ranges::move(items_of_views(item), std::back_inserter(dataset.items));
    else
      dataset.items.push_back(std::move(item));
  }
  dataset.unit = found.layout.unit;
  if (truth == nullptr || truth->cameras.empty()) return dataset;
  const FoundCameras cameras(folder, truth->cameras);
  for (DatasetItem& item : dataset.items)
    if (!item.saliency.empty() || !item.picks.empty()) add_cameras(cameras, truth->cameras, item);
  if (!truth->cameras.file.empty()) dataset.read.push_back((folder / truth->cameras.file).lexically_normal());
  return dataset;
}

}  // namespace salbench
