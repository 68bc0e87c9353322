// SPDX-License-Identifier: GPL-3.0-or-later
// Data sets (io/dataset.h, pipeline/inputs): an item's files are read when it is asked for, without the
// interpreter's lock, and its arrays show the memory that they were read into.
#include <algorithm>
#include <any>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "io/cloud_file.h"
#include "pipeline/config/data_layout.h"
#include "pipeline/config/option_text.h"
#include "pipeline/inputs/given_truth.h"
#include "pipeline/inputs/inputs.h"
#include "pipeline/inputs/loading.h"
#include "python/computing.h"
#include "python/loaded.h"
#include "python/module.h"
#include "stages/core/errors.h"

namespace salbench::python {
namespace {

namespace py = pybind11;

std::shared_ptr<const Loaded> load(const std::any& source) {
  const DatasetItem& item = item_of(source);
  const std::vector<FileData> of_shape = read_all({mesh_file_of(item)});
  const Files shape_file{source, item.name, of_shape};
  const std::vector<FileData> of_truth = read_all(truth_files_of(item));
  const Files truth_files{source, item.name, of_truth};

  auto loaded = std::make_shared<Loaded>();
  std::string remark;
  if (holds_cloud(item, of_shape[0].text())) {
    const auto& cloud = loaded->shape.emplace<PointCloud>(load_cloud(shape_file, Remark{remark}));
    const bool needs_surface =
        !of_truth.empty() &&
        (!item.cameras.empty() || measured_cloud_truth(cloud, {}, truth_files).saliency.empty());
    const Faces surface = needs_surface ? surface_of(cloud) : Faces();
    if (!of_truth.empty()) loaded->truth = given_cloud_truth(cloud, surface, truth_files);
  } else {
    const auto& mesh = loaded->shape.emplace<Mesh>(load_mesh(shape_file, Remark{remark}));
    if (!of_truth.empty()) loaded->truth = given_truth(mesh, truth_files);
  }
  return loaded;
}

// Throws FileError in place of ShapeError.
std::shared_ptr<const Loaded> load_named(const std::any& source) {
  try {
    return load(source);
  } catch (const ShapeError& error) {
    throw FileError(item_of(source).mesh, error.what());
  }
}

Twins twins_from(const std::string& word) {
  Twins kept = Twins::refuse;
  if (!parse_option(word, kept))
    throw py::value_error(
        fmt::format("twins must be one of {}, not '{}'", fmt::join(EnumNames<Twins>::names, ", "), word));
  return kept;
}

class Data {
 public:
  // `items`: None, a text such as "1-20,52", or a list of names. An empty split stands for all.
  Data(const std::string& layout, const std::string& root, const std::string& twins, const py::object& items,
       const std::string& split) {
    const Twins kept = twins_from(twins);
    salbench::Dataset found = computed(1, [&] { return find_dataset(root, layouts_of(layout), kept); });
    layout_ = found.layout;
    for (const DatasetItem& item : found.items)
      if (!item.split.empty()) splits_.insert(item.split);
    choose(found, items, split);
    notes_ = std::move(found.notes);
    for (DatasetItem& item : found.items) items_.emplace_back(std::move(item));
  }

  std::string layout() const { return layout_; }
  std::vector<std::string> notes() const { return notes_; }

  std::vector<std::string> splits() const { return {splits_.begin(), splits_.end()}; }

  // (name, category, split) of each.
  py::list items() const {
    py::list rows;
    for (const std::any& source : items_) {
      const DatasetItem& item = item_of(source);
      rows.append(py::make_tuple(file_text(item.name), file_text(item.category), file_text(item.split)));
    }
    return rows;
  }

  // points, faces, normals, ground truth, participants, viewers; None where the files have none.
  py::tuple load(std::size_t i) const {
    const std::any& source = items_.at(i);
    return arrays_of(computed(1, [&] { return load_named(source); }));
  }

 private:
  static void require_known(const std::vector<DatasetItem>& items, const std::string& name) {
    std::vector<std::string_view> known;
    for (const DatasetItem& item : items) {
      if (item.name == name || item.shape_name() == name) return;
      known.push_back(item.name);
    }
    fail_unknown("item", name, known);
  }

  static void choose(salbench::Dataset& found, const py::object& wanted, const std::string& split) {
    if (py::isinstance<py::bytes>(wanted)) {
      const auto selection = wanted.cast<std::string>();
      if (split_list(selection).empty()) throw py::value_error("items names no item");
      return select_items(found, selection, split);
    }
    select_items(found, {}, split);
    if (wanted.is_none()) return;
    const auto names = wanted.cast<std::vector<std::string>>();
    for (const std::string& name : names) require_known(found.items, name);
    const std::set<std::string> kept(names.begin(), names.end());
    std::erase_if(found.items, [&](const DatasetItem& item) {
      return !kept.contains(item.name) && !kept.contains(item.shape_name());
    });
  }

  std::string layout_;
  std::vector<std::string> notes_;
  std::set<std::string> splits_;
  std::vector<std::any> items_;  // of DatasetItem
};

py::list texts(const std::vector<std::string>& all) {
  py::list list;
  for (const std::string& text : all) list.append(file_text(text));
  return list;
}

// As `salbench _list` has an item; one of the one form has `form`, its file, in place of `native`.
py::dict row_of(const DatasetItem& item) {
  py::dict row;
  row["name"] = file_text(item.name);
  row["shape"] = file_text(item.shape_name());
  row["view"] = file_text(item.view);
  row["category"] = file_text(item.category);
  row["split"] = file_text(item.split);
  row["problem"] = file_text(item.problem);
  if (item.indexed) {
    row["kind"] = item.indexed->is_cloud ? "cloud" : "mesh";
    row["truth"] = item.indexed->has_truth;
    row["participants"] = item.indexed->participants;
    row["viewers"] = item.indexed->viewers;
    row["form"] = file_text(item.mesh);
    return row;
  }
  row["kind"] = "";  // the file tells
  row["truth"] = !item.saliency.empty() || !item.picks.empty();
  row["participants"] = item.picks.size();
  row["viewers"] = 0;
  py::dict native;
  native["mesh"] = file_text(item.mesh);
  native["saliency"] = texts(item.saliency);
  native["picks"] = texts(item.picks);
  row["native"] = native;
  return row;
}

// The listing of a layout that the program lists by itself, as `salbench _list` has it.
py::dict native_items(const std::string& layout, const std::string& root, const std::string& twins) {
  const Twins kept = twins_from(twins);
  const salbench::Dataset found = computed(1, [&] { return find_dataset(root, layouts_of(layout), kept); });
  py::list items;
  for (const DatasetItem& item : found.items) items.append(row_of(item));
  py::dict listing;
  listing["layout"] = file_text(found.layout);
  listing["notes"] = texts(found.notes);
  listing["read"] = texts(found.read);
  listing["licence"] = file_text(found.licence);
  listing["items"] = items;
  return listing;
}

// What the program reads by itself: a mesh or a cloud, values per point, picks per participant.
std::any native_item(const std::string& name, const std::string& mesh, std::vector<std::string> saliency,
                     std::vector<std::string> picks) {
  return DatasetItem{
      .name = name, .category = {}, .mesh = mesh, .saliency = std::move(saliency), .picks = std::move(picks)};
}

py::tuple load_native(const std::string& name, const std::string& mesh, std::vector<std::string> saliency,
                      std::vector<std::string> picks) {
  const std::any item = native_item(name, mesh, std::move(saliency), std::move(picks));
  return arrays_of(computed(1, [&] { return load_named(item); }));
}

// The same as fields of a Form, its mesh as the file has it, and no saliency made from picks.
py::dict native_form(const std::string& name, const std::string& mesh, std::vector<std::string> saliency,
                     std::vector<std::string> picks) {
  const std::any source = native_item(name, mesh, std::move(saliency), std::move(picks));
  return fields_of(computed(1, [&] {
    const DatasetItem& item = item_of(source);
    const std::vector<FileData> of_shape = read_all({mesh_file_of(item)});
    const std::vector<FileData> of_truth = read_all(truth_files_of(item));
    const Files shape_file{source, name, of_shape}, truth_files{source, name, of_truth};
    ShapeInForm shape{.is_cloud = holds_cloud(item, of_shape[0].text())};
    std::string remark;
    if (shape.is_cloud)
      shape.cloud = load_cloud(shape_file, Remark{remark});
    else
      shape.mesh = parsed_mesh(shape_file, &shape.polygons);
    if (!of_truth.empty())
      shape.truths.push_back({.truth = shape.is_cloud ? measured_cloud_truth(shape.cloud, {}, truth_files)
                                                      : measured_truth(shape.mesh, truth_files)});
    return shape;
  }));
}

// KeyError for a name that no layout has.
void require_layout(const std::string& layout) {
  if (!is_layout(layout)) fail_unknown("layout", layout, layout_names());
}

}  // namespace

void bind_data(py::module_& module) {
  module.def("layouts", &layout_names);
  module.def("require_layout", &require_layout);
  module.def("native_items", &native_items, py::arg("layout"), py::arg("root"), py::arg("twins") = "refuse");
  module.def("load_native", &load_native, py::arg("name"), py::arg("mesh"), py::arg("saliency"),
             py::arg("picks"));
  module.def("native_form", &native_form, py::arg("name"), py::arg("mesh"), py::arg("saliency"),
             py::arg("picks"));
  py::class_<Data>(module, "Data")
      .def(py::init<const std::string&, const std::string&, const std::string&, const py::object&,
                    const std::string&>())
      .def("items", &Data::items)
      .def("load", &Data::load)
      .def_property_readonly("layout", &Data::layout)
      .def_property_readonly("notes", &Data::notes)
      .def_property_readonly("splits", &Data::splits);
}

}  // namespace salbench::python
