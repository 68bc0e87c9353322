// SPDX-License-Identifier: GPL-3.0-or-later
// Data sets (io/dataset.h, pipeline/inputs): an item's files are read when it is asked for, without the
// interpreter's lock, and its arrays show the memory that they were read into.
#include <algorithm>
#include <any>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "io/cloud_file.h"
#include "pipeline/config/data_layout.h"
#include "pipeline/config/option_text.h"
#include "pipeline/inputs/given_truth.h"
#include "pipeline/inputs/inputs.h"
#include "pipeline/inputs/loading.h"
#include "pipeline/rules/config.h"
#include "python/arrays.h"
#include "python/computing.h"
#include "python/module.h"
#include "stages/core/errors.h"
#include "stages/normals/normals.h"
#include "stages/surface/surface.h"

namespace salbench::python {
namespace {

// The shape and the ground truth in the files of an item.
struct Loaded {
  std::variant<Mesh, PointCloud> shape;
  std::optional<GroundTruth> truth;
};

// The partial mesh, which picks are smoothed over and which hides points from a camera, with the options that
// a configuration has by itself.
Faces surface_of(const PointCloud& cloud) {
  const Config defaults = read_config(Section::from_text("{}", "defaults"), "python");
  return partial_mesh(cloud.points, cloud_normals(cloud, defaults.scan_normals), defaults.surface);
}

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

// Names and paths as the system has them, which may be no UTF-8.
py::str file_text(const std::string& bytes) {
  PyObject* text = PyUnicode_DecodeFSDefaultAndSize(bytes.data(), static_cast<py::ssize_t>(bytes.size()));
  if (text == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::str>(text);
}

template <class T>
py::object shown_of(const std::shared_ptr<const Loaded>& owner, const std::vector<T>& values) {
  return read_only(shown(owner, std::span<const T>(values)));
}

template <class T>
py::tuple all_shown(const std::shared_ptr<const Loaded>& owner, const std::vector<std::vector<T>>& all) {
  py::tuple arrays(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) arrays[i] = shown_of(owner, all[i]);
  return arrays;
}

class Data {
 public:
  // `items`: None, a text such as "1-20,52", or a list of names. An empty split stands for all.
  Data(const std::string& layout, const std::string& root, const std::string& twins, const py::object& items,
       const std::string& split) {
    Twins kept = Twins::refuse;
    if (!parse_option(twins, kept))
      throw py::value_error(
          fmt::format("twins must be one of {}, not '{}'", fmt::join(EnumNames<Twins>::names, ", "), twins));
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
    const auto loaded = computed(1, [&] {
      try {
        return python::load(source);
      } catch (const ShapeError& error) {
        throw FileError(item_of(source).mesh, error.what());
      }
    });
    py::object points, faces = py::none(), normals = py::none(), saliency = py::none();
    if (const auto* mesh = std::get_if<Mesh>(&loaded->shape)) {
      points = shown_of(loaded, mesh->vertices);
      faces = shown_of(loaded, mesh->faces);
    } else {
      const auto& cloud = std::get<PointCloud>(loaded->shape);
      points = shown_of(loaded, cloud.points);
      if (!cloud.normals.empty()) normals = shown_of(loaded, cloud.normals);
    }
    if (!loaded->truth) return py::make_tuple(points, faces, normals, saliency, py::tuple(), py::tuple());
    return py::make_tuple(points, faces, normals, shown_of(loaded, loaded->truth->saliency),
                          all_shown(loaded, loaded->truth->picks), all_shown(loaded, loaded->truth->viewers));
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

// KeyError for a name that no layout has.
void require_layout(const std::string& layout) {
  if (!is_layout(layout)) fail_unknown("layout", layout, layout_names());
}

}  // namespace

void bind_data(py::module_& module) {
  module.def("layouts", &layout_names);
  module.def("require_layout", &require_layout);
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
