// SPDX-License-Identifier: GPL-3.0-or-later
// A layout is a list of places: where the meshes may lie and, for each, where their ground truth may. The
// first place with a mesh is taken, so the result depends on the names in the folders alone.

#include "io/dataset.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "io/cloud_file.h"
#include "io/file.h"
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
  const LayoutRow* layout;
  Place place;
  std::vector<fs::path> meshes;
};

// The files in a folder that `wanted` accepts, without hidden ones, in natural order.
template <class Wanted>
std::vector<fs::path> files_in(const fs::path& folder, const Wanted& wanted) {
  std::vector<fs::path> files;
  for (FolderEntry& entry : list_folder(folder))
    if (!entry.is_folder && !entry.path.filename().native().starts_with('.') && wanted(entry.path))
      files.push_back(std::move(entry.path));
  std::sort(files.begin(), files.end(),
            [](const fs::path& a, const fs::path& b) { return natural_less(a.native(), b.native()); });
  return files;
}

std::vector<fs::path> files_in(const fs::path& folder, const char* extension) {
  return files_in(folder, [&](const fs::path& file) { return file.extension() == extension; });
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_digits(std::string_view text) { return std::all_of(text.begin(), text.end(), is_digit); }

bool is_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

TruthFolders schelling_truth(const fs::path& base) { return {base / "Distributions", base / "RawData"}; }
TruthFolders gs_truth(const fs::path& base) { return {base / "Saliency", base / "RawData"}; }

// ROOT itself, or the folders that archives of the study unpack to.
std::vector<fs::path> schelling_bases(const fs::path& root) {
  return {root, root / "SchellingData", root / "SchellingData" / "SchellingData"};
}

std::vector<TruthFolders> truth_below(const fs::path& root) {
  std::vector<TruthFolders> truth = {gs_truth(root / "GS")};
  for (const fs::path& base : schelling_bases(root)) truth.push_back(schelling_truth(base));
  return truth;
}

fs::path beside(const fs::path& folder, const char* name) {
  return (folder / ".." / name).lexically_normal();
}

std::vector<Place> gs_places(const fs::path& root) {
  std::vector<Place> places;
  for (const char* meshes : {"off", "Meshes"}) {
    if (is_folder(root / "GS")) places.push_back({root / meshes, {gs_truth(root / "GS")}});
    if (is_folder(root / "Saliency")) {
      places.push_back({root / meshes, {gs_truth(root)}});
      places.push_back({beside(root, meshes), {gs_truth(root)}});
    }
  }
  return places;
}

std::vector<Place> schelling_places(const fs::path& root) {
  std::vector<Place> places;
  for (const fs::path& base : schelling_bases(root))
    places.push_back({base / "Meshes", {schelling_truth(base)}});
  return places;
}

std::vector<Place> princeton_places(const fs::path& root) {
  std::vector<Place> places;
  for (const fs::path& base : {root, root / "data", root / "MeshsegBenchmark-1.0" / "data"})
    places.push_back({base / "off", truth_below(root)});
  if (root.filename() == "off") places.push_back({root, truth_below(beside(root, "."))});
  return places;
}

std::vector<Place> folder_places(const fs::path& root) {
  return {{root, {schelling_truth(root), schelling_truth(beside(root, "."))}}};
}

// In this order, since meshes in Meshes/ with their ground truth in GS/ would pass for the Schelling layout.
constexpr std::array kLayouts = {LayoutRow{name_of(Layout::gs), gs_places, true},
                                 LayoutRow{name_of(Layout::schelling), schelling_places, true},
                                 LayoutRow{name_of(Layout::princeton), princeton_places, true},
                                 LayoutRow{name_of(Layout::folder), folder_places, false}};

std::optional<Found> find_layout(const fs::path& root, const LayoutRow& layout) {
  for (const Place& place : layout.places(root)) {
    std::vector<fs::path> meshes = files_in(place.meshes, has_shape_extension);
    if (!meshes.empty()) return Found{&layout, place, std::move(meshes)};
  }
  return {};
}

std::string where_looked_for(const fs::path& root, const LayoutRow& layout) {
  std::set<std::string> folders;
  for (const Place& place : layout.places(root)) folders.insert(place.meshes.string());
  if (folders.empty()) return fmt::format("{} (with neither GS/ nor Saliency/ in it)", root.string());
  return fmt::format("{}", fmt::join(folders, ", "));
}

Found find_meshes(const fs::path& root, std::span<const LayoutRow> layouts) {
  if (!is_folder(root)) throw InputError(fmt::format("{}: there is no such folder", root.string()));
  std::vector<std::string> searched;
  for (const LayoutRow& layout : layouts) {
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

ItemsByName items_of(const Found& found, Twins twins, std::vector<std::string>& notes) {
  std::vector<NamedFile> files;
  for (const fs::path& mesh : found.meshes) files.push_back({mesh.stem(), mesh});
  ItemsByName items;
  for (const auto& [name, mesh] : without_twins(files, twins, notes)) {
    DatasetItem item{.name = name, .category = {}, .mesh = mesh, .saliency = {}, .picks = {}};
    if (const int number = benchmark_number(item.name); number > 0 && found.layout->is_benchmark)
      item.category = kCategories[static_cast<std::size_t>((number - 1) / kMeshesPerCategory)];
    items.emplace(name, std::move(item));
  }
  return items;
}

// "michael3" of "michael3_0.pid"; empty if the file is not named in this way.
std::string picked_item(const fs::path& file) {
  const std::string stem = file.stem();
  const std::size_t bar = stem.rfind('_');
  if (bar == stem.npos || bar + 1 == stem.size() || !is_digits(stem.substr(bar + 1))) return {};
  return stem.substr(0, bar);
}

// Gives each item its files and notes the files that belong to none.
void add_truth(const TruthFolders& folders, ItemsByName& items, std::vector<std::string>& notes) {
  std::map<std::string, std::string, NaturalLess> without_mesh;  // name -> one of its files
  for (const fs::path& file : files_in(folders.saliency, ".val")) {
    if (const auto item = items.find(file.stem().native()); item != items.end())
      item->second.saliency = file;
    else
      without_mesh.emplace(file.stem(), file);
  }
  for (const fs::path& file : files_in(folders.picks, ".pid")) {
    const std::string name = picked_item(file);
    if (const auto item = items.find(name); item != items.end())
      item->second.picks.push_back(file);
    else if (name.empty())
      notes.push_back(fmt::format("{}: is not named NAME_NUMBER.pid and was left out", file.string()));
    else
      without_mesh.emplace(name, file);
  }
  for (const auto& [name, file] : without_mesh)
    notes.push_back(fmt::format("{}: ground truth without a mesh ({})", name, file));
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

std::span<const LayoutRow> layout_rows() { return kLayouts; }

Dataset find_dataset(const fs::path& root, Layout layout, Twins twins) {
  if (layout == Layout::automatic) return find_dataset(root, kLayouts, twins);
  const auto row = std::find_if(kLayouts.begin(), kLayouts.end(),
                                [&](const LayoutRow& of) { return of.name == name_of(layout); });
  return find_dataset(root, {row, 1}, twins);
}

Dataset find_dataset(const fs::path& root, std::span<const LayoutRow> layouts, Twins twins) {
  fs::path folder = root.lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();  // "data/" is "data"
  const Found found = find_meshes(folder, layouts);
  Dataset dataset;
  ItemsByName items = items_of(found, twins, dataset.notes);
  dataset.layout = found.layout->name;
  note_missing_numbers(items, dataset.notes);
  const auto truth = std::find_if(
      found.place.truth.begin(), found.place.truth.end(),
      [](const TruthFolders& folders) { return is_folder(folders.saliency) || is_folder(folders.picks); });
  if (truth != found.place.truth.end()) add_truth(*truth, items, dataset.notes);
  for (auto& [name, item] : items) dataset.items.push_back(std::move(item));
  return dataset;
}

bool natural_less(std::string_view a, std::string_view b) {
  const auto digits_at = [](std::string_view text, std::size_t at) {
    const auto begin = text.begin() + static_cast<std::ptrdiff_t>(at);
    return std::string_view(begin, std::find_if_not(begin, text.end(), is_digit));
  };
  const auto significant = [](std::string_view digits) {
    digits.remove_prefix(std::min(digits.find_first_not_of('0'), digits.size()));
    return digits;
  };
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (is_digit(a[i]) && is_digit(b[j])) {
      const std::string_view run_a = digits_at(a, i), run_b = digits_at(b, j);
      const std::string_view x = significant(run_a), y = significant(run_b);
      if (x != y) return x.size() != y.size() ? x.size() < y.size() : x < y;
      i += run_a.size();
      j += run_b.size();
    } else {
      if (a[i] != b[j]) return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]);
      ++i;
      ++j;
    }
  }
  if (i < a.size() || j < b.size()) return j < b.size();
  return a < b;  // equal but for leading zeros
}

}  // namespace salbench
