// SPDX-License-Identifier: GPL-3.0-or-later
// A layout is a list of places for shapes, each with places for its ground truth. The first place with a
// shape is used, so that the result depends only on names in the folders.
#include "io/shapes/dataset.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "io/file.h"
#include "io/hdf5/one_form_index.h"
#include "io/shapes/cloud_file.h"
#include "io/shapes/text_scanner.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

// Ground truth: Distributions/NAME.val, RawData/NAME_NUMBER.pid, in the first of `truth` with either folder.
struct Place {
  std::string_view shapes;                   // relative to the data set's folder
  std::vector<std::string_view> truth = {};  // likewise
};

struct Layout {
  std::string_view name;
  bool has_classes;  // has the classes of SHREC'07
  std::vector<Place> places;
};

const std::array<Layout, 2>& layouts() {
  static const std::array<Layout, 2> all = {
      {{kSchelling,
        true,
        {{"Meshes", {"."}},
         {"SchellingData/Meshes", {"SchellingData"}},
         {"SchellingData/SchellingData/Meshes", {"SchellingData/SchellingData"}}}},
       {kFolder, false, {{".", {".", ".."}}}}}};
  return all;
}

const Layout& layout_named(std::string_view name) {
  const auto* const found = std::ranges::find(layouts(), name, &Layout::name);
  if (found == layouts().end()) throw std::logic_error(fmt::format("{} is no layout of this program", name));
  return *found;
}

// Classes of SHREC'07 in the order of their meshes, twenty each. [giorgi2007]
constexpr std::array<std::string_view, 20> kCategories = {
    "human",     "cup",   "glasses",  "airplane", "ant",  "chair",      "octopus",
    "table",     "teddy", "hand",     "plier",    "fish", "bird",       "spring",
    "armadillo", "buste", "mechanic", "bearing",  "vase", "four-legged"};
constexpr int kMeshesPerCategory = 20;
constexpr int kBenchmarkMeshes = static_cast<int>(kCategories.size()) * kMeshesPerCategory;

// 1..400, or 0 for a name that is not such a number.
int benchmark_number(const std::string& name) {
  if (name.empty() || name.size() > 3 || name[0] == '0' || !is_digits(name)) return 0;
  const int number = std::stoi(name);
  return number <= kBenchmarkMeshes ? number : 0;
}

std::string category_of(int number) {
  return std::string(kCategories[static_cast<std::size_t>((number - 1) / kMeshesPerCategory)]);
}

struct NaturalLess {
  using is_transparent = void;
  bool operator()(std::string_view a, std::string_view b) const { return natural_less(a, b); }
};
using ItemsByName = std::map<std::string, Item, NaturalLess>;

fs::path below(const fs::path& root, std::string_view folder) { return (root / folder).lexically_normal(); }

// Visible files of the folder in natural order.
std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<std::string> names;
  visit_names(folder, [&](std::string_view name, bool is_folder) {
    if (!is_folder && !name.starts_with('.')) names.emplace_back(name);
  });
  std::ranges::sort(names, natural_less);
  std::vector<fs::path> files;
  for (const std::string& name : names) files.push_back(folder / name);
  return files;
}

struct NamedFile {
  std::string name;  // without extension
  fs::path path;
};

// Files with their names. Throws InputError if two files share a name.
std::vector<NamedFile> named(const std::vector<fs::path>& files) {
  std::vector<NamedFile> named;
  std::map<std::string, fs::path> first_of;
  for (const fs::path& file : files) {
    if (const auto [first, is_new] = first_of.emplace(file.stem(), file); !is_new)
      throw InputError(fmt::format("{} and {} have the same name: rename or remove one of them",
                                   first->second.string(), file.string()));
    named.push_back({file.stem(), file});
  }
  return named;
}

// Files with an extension, in either case.
std::vector<NamedFile> files_ending(const fs::path& folder, std::string_view extension) {
  std::vector<fs::path> files = files_in(folder);
  std::erase_if(files, [&](const fs::path& file) { return lower_case_extension(file) != extension; });
  return named(files);
}

std::vector<fs::path> shapes_in(const fs::path& folder) {
  std::vector<fs::path> files = files_in(folder);
  std::erase_if(files, [](const fs::path& file) { return !has_shape_extension(file); });
  return files;
}

const Place* first_with_shapes(const fs::path& root, const Layout& layout) {
  for (const Place& place : layout.places)
    if (has_shapes(below(root, place.shapes))) return &place;
  return nullptr;
}

// Items have classes if the layout has and all are named as meshes of the benchmark.
ItemsByName items_in(const fs::path& folder, bool has_classes) {
  ItemsByName items;
  for (const auto& [name, file] : named(shapes_in(folder))) {
    items.emplace(name, Item{.name = name, .file = file});
    has_classes = has_classes && benchmark_number(name) > 0;
  }
  if (has_classes)
    for (auto& [name, item] : items) item.category = category_of(benchmark_number(name));
  return items;
}

// Adds ground truth from a folder to its items, with a note on files without an item.
void add_truth(const fs::path& folder, ItemsByName& items, std::vector<std::string>& notes) {
  std::set<std::string, NaturalLess> without_shape;  // names
  const auto item_named = [&](const std::string& name) {
    const auto item = items.find(name);
    if (item != items.end()) return &item->second;
    without_shape.insert(name);
    return static_cast<Item*>(nullptr);
  };
  for (const auto& [stem, file] : files_ending(folder / "Distributions", ".val"))
    if (Item* item = item_named(stem)) item->saliency = file;
  for (const auto& [stem, file] : files_ending(folder / "RawData", ".pid")) {
    const std::size_t end = stem.rfind('_');
    if (end == std::string::npos || end == 0 || end + 1 == stem.size() || !is_digits(stem.substr(end + 1)))
      notes.push_back(fmt::format("{}: is not named NAME_NUMBER.pid and was left out", file.string()));
    else if (Item* item = item_named(stem.substr(0, end)))
      item->picks.push_back(file);
  }
  if (without_shape.empty()) return;
  constexpr std::size_t kNamed = 8;
  std::vector<std::string> names;
  for (const std::string& name : without_shape)
    if (names.size() < kNamed) names.push_back(name);
  const std::size_t others = without_shape.size() - names.size();
  notes.push_back(fmt::format("{}: ground truth without a mesh or point cloud: {}{}", folder.string(),
                              fmt::join(names, ", "),
                              others > 0 ? fmt::format(" and {} others", others) : ""));
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

// Notes missing meshes of the benchmark; no note unless all items are meshes of the benchmark.
void note_missing_numbers(const ItemsByName& items, std::vector<std::string>& notes) {
  for (const auto& [name, item] : items)
    if (item.category.empty()) return;
  std::vector<int> missing;
  for (int number = 1; number <= kBenchmarkMeshes; ++number)
    if (!items.contains(std::to_string(number))) missing.push_back(number);
  if (!missing.empty())
    notes.push_back(fmt::format(
        "{} of the {} meshes of SHREC'07 are here, without {}; all have its classes: if these are other "
        "shapes, set layout: folder and pass --data {}",
        items.size(), kBenchmarkMeshes, ranges(missing),
        fs::path(items.begin()->second.file).parent_path().string()));
}

}  // namespace

bool Item::has_truth() const {
  return !problem.empty() || with_truth || is_recorded() || !saliency.empty() || !picks.empty();
}

fs::path data_folder(const fs::path& root) {
  const fs::path folder = root.lexically_normal();
  return folder.has_filename() ? folder : folder.parent_path();
}

bool has_shapes(const fs::path& folder) {
  bool found = false;
  visit_names(folder, [&](std::string_view name, bool is_folder) {
    found = found || (!is_folder && !name.starts_with('.') && has_shape_extension(name));
  });
  return found;
}

bool fits_layout(const fs::path& root, std::string_view layout) {
  return layout == kOneForm ? size_of_file(root / kIndexFile).has_value()
                            : first_with_shapes(root, layout_named(layout)) != nullptr;
}

std::string places_of(const fs::path& root, std::string_view layout) {
  std::set<std::string> places;
  for (const Place& place : layout_named(layout).places) places.insert(below(root, place.shapes));
  return fmt::format("{}", fmt::join(places, ", "));
}

Dataset native_dataset(const fs::path& root, std::string_view layout) {
  require_folder(root);
  if (layout == kOneForm) return indexed_dataset(root);
  const Layout& known = layout_named(layout);
  const Place* place = first_with_shapes(root, known);
  if (place == nullptr)
    throw InputError(fmt::format(
        "{}: no .off, .obj or .ply meshes found, and no .ply, .pcd or .xyz point clouds; looked in {}: {}",
        root.string(), layout, places_of(root, layout)));
  Dataset dataset{.layout = std::string(layout), .items = {}, .notes = {}};
  ItemsByName items = items_in(below(root, place->shapes), known.has_classes);
  if (known.has_classes) note_missing_numbers(items, dataset.notes);
  for (const std::string_view name : place->truth)
    if (const fs::path folder = below(root, name);
        is_folder(folder / "Distributions") || is_folder(folder / "RawData")) {
      add_truth(folder, items, dataset.notes);
      if (name == ".." && root.filename() == "Meshes" && benchmark_number(items.begin()->first) > 0)
        dataset.notes.push_back(fmt::format(
            "{}: without classes; the folder above it, as data set, has those of SHREC'07", root.string()));
      break;
    }
  for (auto& [name, item] : items) dataset.items.push_back(std::move(item));
  return dataset;
}

}  // namespace salbench
