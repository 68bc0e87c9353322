// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/inputs/conversion.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "io/file.h"
#include "io/one_form.h"
#include "io/one_form_index.h"
#include "pipeline/inputs/given_truth.h"
#include "pipeline/inputs/inputs.h"
#include "pipeline/inputs/loading.h"
#include "stages/core/errors.h"
#include "stages/core/mesh_check.h"
#include "stages/core/parallel.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

// Where the source's items stand in it, and the place of each in the index.
struct Source {
  fs::path root;
  std::string layout, licence;
  std::map<std::string, std::size_t> places;  // name of an item -> its place

  // "9f86d081884c7d659a2feaa0c55ad015  Meshes/cow.off", as xxh128sum prints.
  std::string described(const std::string& path, const Digest& digest) const {
    const fs::path below = fs::path(path).lexically_relative(root);
    return fmt::format("{}  {}\n", digest.hex(), (below.empty() ? fs::path(path) : below).string());
  }
};

// What a shape's file is made of: its families, one or one for each view.
struct ShapeReader {
  const Source& source;
  const Inputs& inputs;
  std::map<std::string, std::string> files = {};  // path -> line that describes it

  std::vector<FileData> read(const FilesOfUnit& of_unit) {
    std::vector<FileData> all = read_all(of_unit);
    for (std::size_t i = 0; i < all.size(); ++i)
      files[of_unit[i].place] = source.described(of_unit[i].place, *all[i].digest);
    return all;
  }

  // The shape, and what is scored of it. Picks of views are those of the shape.
  void add_shape(ShapeInForm& shape, std::size_t family) {
    const Family& of = inputs.units.families()[family];
    const std::vector<FileData> data = read(inputs.shape_files->files[family]);
    const Files in{of.source, of.name, data};
    std::string remark;
    shape.is_cloud = of.level == kClouds;
    if (shape.is_cloud)
      shape.cloud = load_cloud(in, Remark{remark});
    else
      check_mesh(shape.mesh = parsed_mesh(in, &shape.polygons));
  }
  void add_truth(ShapeInForm& shape, std::size_t family) {
    const Family& of = inputs.units.families()[family];
    const FilesOfUnit& truth_files = inputs.truth_files->files[family];
    if (truth_files.empty()) return;
    const std::vector<FileData> data = read(truth_files);
    const Files in{of.source, of.name, data};
    const DatasetItem& item = item_of(of.source);
    if (!item.cameras.empty() && (of.level == kClouds || item.saliency.empty()))
      throw InputError(fmt::format("{}: what was seen of {} is computed in a run, and has no place in the one form: "
                                   "give a mask in place of the camera",
                                   item.cameras[0].where, of.name));
    TruthInForm truth{.view = item.view};
    if (!truth.view.empty() && !may_be_name(truth.view))
      throw InputError(
          fmt::format("{}: a view cannot be called '{}': rename its files", of.name, truth.view));
    truth.truth = of.level == kClouds ? measured_cloud_truth(shape.cloud, {}, in, &truth.as_read)
                                      : measured_truth(shape.mesh, in, &truth.as_read);
    shape.truths.push_back(std::move(truth));
  }

  TextAttributes about(const DatasetItem& item) const {
    std::string lines;
    for (const auto& [path, line] : files) lines += line;
    return {{"item", item.shape_name()},
            {"class", item.category},
            {"split", item.split},
            {"source", source.layout},
            {"source_files", lines},
            {"viewers", item.by_viewer ? fmt::format("{}", fmt::join(item.views, "\n")) : ""},
            {"licence", source.licence}};
  }
};

// Replaces the file unless it holds these bytes.
Outcome put(const fs::path& file, const Bytes& bytes) {
  if (const auto before = read_bytes(file); before && *before == bytes) return Outcome::unchanged;
  write_file(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  return Outcome::written;
}

IndexRow row_of(const Source& source, const Family& family, bool has_truth) {
  const DatasetItem& item = item_of(family.source);
  return {.shape = item.shape_name(),
          .view = item.view,
          .category = item.category,
          .split = item.split,
          .facts = {.is_cloud = family.level == kClouds,
                    .has_truth = has_truth,
                    .participants = item.picks.size(),
                    .viewers = item.by_viewer ? item.saliency.size() : 0},
          .source = source.layout};
}

struct Done {
  ConvertedShape shape;
  std::vector<IndexRow> rows;
};

// `families`: those of one shape. A view that fails is left out, and the others go on.
Done convert_shape(const Source& source, const Inputs& inputs, std::span<const std::size_t> families,
                   const fs::path& to) {
  const auto family = [&](std::size_t i) -> const Family& { return inputs.units.families()[i]; };
  const DatasetItem& item = item_of(family(families[0]).source);
  Done done{{.name = item.shape_name()}, {}};
  ShapeReader conversion{source, inputs};
  ShapeInForm shape;
  try {
    conversion.add_shape(shape, families[0]);
  } catch (const InputError& error) {
    done.shape.problem = error.what();
    return done;
  }
  for (const std::size_t i : families) try {
      conversion.add_truth(shape, i);
      done.rows.push_back(row_of(source, family(i), !inputs.truth_files->files[i].empty()));
    } catch (const InputError& error) {
      if (done.shape.problem.empty()) done.shape.problem = error.what();
    }
  if (done.rows.empty()) return done;
  shape.about = conversion.about(item);
  done.shape.outcome = put(to / file_of_shape(item.shape_name()), one_form_image(shape));
  return done;
}

// The index that is there, of the same set.
std::vector<IndexRow> rows_before(const fs::path& to, const Source& source) {
  const fs::path file = to / kIndexFile;
  if (!size_of_file(file)) return {};
  const auto refuse = [&](const std::string& what) {
    throw ConfigError(fmt::format("--to {}: {}; choose another folder", to.string(), what));
  };
  std::vector<IndexRow> rows;
  try {
    rows = read_index(file);
  } catch (const InputError& error) {
    refuse(fmt::format("holds something else: {}", error.what()));
  }
  bool any_known = rows.empty();
  for (const IndexRow& row : rows) {
    if (row.source != source.layout)
      refuse(fmt::format("holds another set, read with the layout {}", row.source));
    any_known |= source.places.contains(row.name());
  }
  if (!any_known) refuse(fmt::format("holds another set, of which no item is in {}", source.root.string()));
  return rows;
}

// The families of each shape, in their order.
std::vector<std::vector<std::size_t>> families_of_shapes(const Inputs& inputs) {
  std::vector<std::vector<std::size_t>> shapes;
  std::map<std::string, std::size_t> place;
  const std::vector<Family>& families = inputs.units.families();
  for (std::size_t i = 0; i < families.size(); ++i) {
    const auto [at, is_new] = place.emplace(item_of(families[i].source).shape_name(), shapes.size());
    if (is_new) shapes.emplace_back();
    shapes[at->second].push_back(i);
  }
  return shapes;
}

// Shapes as a whole, whichever of their views are named.
Dataset selected(const Dataset& all, const std::string& items, const std::string& split) {
  Dataset part = all;
  select_items(part, items, split);
  std::set<std::string> shapes;
  for (const DatasetItem& item : part.items) shapes.insert(item.shape_name());
  part.items = all.items;
  std::erase_if(part.items, [&](const DatasetItem& item) { return !shapes.contains(item.shape_name()); });
  return part;
}

// Rows by their place in the source; those that it no longer has are dropped, and their files removed.
void write_index(const Source& source, std::vector<IndexRow> rows, const fs::path& to,
                 Conversion& conversion) {
  std::set<std::string> kept, gone;
  for (const IndexRow& row : rows) (source.places.contains(row.name()) ? kept : gone).insert(row.shape);
  std::erase_if(rows, [&](const IndexRow& row) { return !source.places.contains(row.name()); });
  std::ranges::sort(rows, {}, [&](const IndexRow& row) { return source.places.at(row.name()); });
  const std::string text = index_text(rows);
  const auto bytes = std::as_bytes(std::span(text));
  put(to / kIndexFile, {bytes.begin(), bytes.end()});
  for (const std::string& shape : gone)
    if (!kept.contains(shape)) {
      remove_file(to / file_of_shape(shape));
      ++conversion.removed;
    }
}

}  // namespace

Conversion convert_data(const fs::path& root, std::span<const Layout> layouts, const std::string& items,
                        const std::string& split, const fs::path& to, Progress& progress,
                        const std::atomic<bool>& stop) {
  const Dataset all = find_dataset(root, layouts);
  Source source{root.lexically_normal(), all.layout, all.licence, {}};
  for (const DatasetItem& item : all.items) source.places.emplace(item.name, source.places.size());
  std::vector<IndexRow> rows = rows_before(to, source);
  const Inputs inputs = read_inputs(selected(all, items, split));
  make_folder(to / "items", "choose another with --to");

  const std::vector<std::vector<std::size_t>> shapes = families_of_shapes(inputs);
  std::vector<std::optional<Done>> all_done(shapes.size());
  progress.begin("converting", shapes.size());
  parallel_ranges(shapes.size(), 1, [&](std::size_t i, std::size_t) {
    if (stop) return;
    all_done[i] = convert_shape(source, inputs, shapes[i], to);
    progress.item_done();
  });
  progress.end();

  Conversion conversion{all.layout, {}, all.notes};
  std::set<std::string> renewed;
  for (const auto& done : all_done)
    if (done) renewed.insert(done->shape.name);
  std::erase_if(rows, [&](const IndexRow& row) { return renewed.contains(row.shape); });
  for (auto& done : all_done) {
    if (!done) continue;
    if (done->shape.outcome == Outcome::failed) remove_file(to / file_of_shape(done->shape.name));
    std::ranges::move(done->rows, std::back_inserter(rows));
    conversion.shapes.push_back(std::move(done->shape));
  }
  write_index(source, std::move(rows), to, conversion);
  return conversion;
}

}  // namespace salbench
