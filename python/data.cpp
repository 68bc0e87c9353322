// SPDX-License-Identifier: GPL-3.0-or-later
// Data sets that C++ lists and reads (io/shapes/dataset.h, pipeline/inputs). Files are read without the
// interpreter's lock, and arrays show the memory that they were read into.
#include <algorithm>
#include <any>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "io/shapes/cloud_file.h"
#include "pipeline/config/option_text.h"
#include "pipeline/inputs/given_truth.h"
#include "pipeline/inputs/inputs.h"
#include "pipeline/inputs/listing.h"
#include "pipeline/inputs/loading.h"
#include "python/computing.h"
#include "python/loaded.h"
#include "python/module.h"
#include "stages/core/errors.h"

namespace salbench::python {
namespace {

namespace py = pybind11;

// Numbers of the items that are chosen. `rows`: name, shape, split and whether there is ground truth, of
// each. An empty split stands for all.
std::vector<std::size_t> chosen_items(const py::list& rows, const py::object& wanted,
                                      const std::string& split, const std::string& splits_where,
                                      const std::string& no_splits) {
  salbench::Dataset found;
  found.splits_where = splits_where;
  found.no_splits = no_splits;
  for (const py::handle row : rows) {
    const auto fields = row.cast<py::tuple>();
    DatasetItem item{.name = file_bytes(fields[0]),
                     .category = std::to_string(found.items.size()),  // its number
                     .mesh = {},
                     .saliency = {},
                     .picks = {}};
    item.shape = file_bytes(fields[1]);
    item.split = file_bytes(fields[2]);
    item.problem = file_bytes(fields[4]);
    item.imported = std::make_shared<const ImportedItem>(
        ImportedItem{.known = {.has_truth = fields[3].cast<bool>()}, .files = {}});
    found.items.push_back(std::move(item));
  }
  select_items(found, choice_of(wanted), split);
  std::vector<std::size_t> chosen;
  for (const DatasetItem& item : found.items) chosen.push_back(std::stoul(item.category));
  return chosen;
}

// As salbench/datasets/listing.py has an item; one of the one form has `form`, its file, in place of
// `native`.
py::dict row_of(const DatasetItem& item) {
  py::dict row;
  row["name"] = file_text(item.name);
  row["shape"] = file_text(item.shape_name());
  row["view"] = file_text(item.view);
  row["category"] = file_text(item.category);
  row["split"] = file_text(item.split);
  row["problem"] = file_text(item.problem);
  if (item.imported) {
    const KnownItem& known = item.imported->known;
    row["kind"] = known.is_cloud ? "cloud" : "mesh";
    row["truth"] = known.has_truth;
    row["participants"] = known.participants;
    row["viewers"] = known.viewers;
    row["recorded"] = known.recorded;
    row["form"] = file_text(item.mesh);
    return row;
  }
  row["kind"] = "";  // the file tells
  row["truth"] = item.has_truth();
  row["participants"] = item.picks.size();
  row["viewers"] = 0;
  row["recorded"] = 0;
  py::dict native;
  native["mesh"] = file_text(item.mesh);
  native["saliency"] =
      file_texts(item.saliency.empty() ? std::vector<std::string>() : std::vector{item.saliency});
  native["picks"] = file_texts(item.picks);
  row["native"] = native;
  return row;
}

// The listing of a layout that C++ lists, as salbench/datasets/listing.py has others.
py::dict native_items(const std::string& layout, const std::string& root) {
  const salbench::Dataset found = computed(1, [&] { return find_dataset(root, layout); });
  py::list items;
  for (const DatasetItem& item : found.items) items.append(row_of(item));
  py::dict listing;
  listing["layout"] = file_text(found.layout);
  listing["notes"] = file_texts(found.notes);
  listing["items"] = items;
  return listing;
}

// The layout that "automatic" stands for.
py::str automatic(const std::string& root) {
  return file_text(computed(1, [&] { return automatic_layout(data_folder(root)); }));
}

// Reads a mesh or a cloud, with values per point and picks per participant. `as_written`: the mesh as its
// file has it.
ShapeInForm native_shape(const DatasetItem& item, bool as_written) {
  const std::vector<FileData> of_shape = {mesh_file_of(item).read()};
  std::vector<File> files = truth_files_of(item);
  const std::vector<FileData> of_truth = read_files(files);
  const std::any source = item;
  const Files shape_file{source, item.name, of_shape}, truth_files{source, item.name, of_truth};
  ShapeInForm shape = shape_in_file(shape_file, holds_cloud(item, of_shape[0].text()));
  std::string remark;
  if (shape.is_cloud)
    shape.cloud = usable_cloud(std::move(shape.cloud), item.name, Remark{remark});
  else if (!as_written)
    shape.mesh = usable_mesh(std::move(shape.mesh), shape.polygons, item.name, Remark{remark});
  if (!of_truth.empty())
    shape.truths.push_back({.truth = shape.is_cloud ? measured_cloud_truth(shape.cloud, truth_files)
                                                    : measured_truth(shape.mesh, truth_files)});
  return shape;
}

DatasetItem native_item(const std::string& name, const std::string& mesh, std::vector<std::string> saliency,
                        std::vector<std::string> picks) {
  return {
      .name = name, .mesh = mesh, .saliency = saliency.empty() ? "" : saliency[0], .picks = std::move(picks)};
}

// Throws FileError in place of ShapeError.
py::tuple load_native(const std::string& name, const std::string& mesh, std::vector<std::string> saliency,
                      std::vector<std::string> picks) {
  const DatasetItem item = native_item(name, mesh, std::move(saliency), std::move(picks));
  return arrays_of(computed(1, [&] {
    try {
      return std::make_shared<const ShapeInForm>(with_saliency(native_shape(item, false)));
    } catch (const ShapeError& error) {
      throw FileError(mesh, error.what());
    }
  }));
}

// Fields of a Form, its mesh as the file has it, and no saliency made from picks.
py::dict native_form(const std::string& name, const std::string& mesh, std::vector<std::string> saliency,
                     std::vector<std::string> picks) {
  const DatasetItem item = native_item(name, mesh, std::move(saliency), std::move(picks));
  return fields_of(computed(1, [&] { return native_shape(item, true); }));
}

}  // namespace

void bind_data(py::module_& module) {
  module.def("automatic_layout", &automatic, py::arg("root"));
  module.def("native_items", &native_items, py::arg("layout"), py::arg("root"));
  module.def("load_native", &load_native, py::arg("name"), py::arg("mesh"), py::arg("saliency"),
             py::arg("picks"));
  module.def("native_form", &native_form, py::arg("name"), py::arg("mesh"), py::arg("saliency"),
             py::arg("picks"));
  module.def("chosen_items", &chosen_items, py::arg("rows"), py::arg("items"), py::arg("split"),
             py::arg("splits_where"), py::arg("no_splits"));
}

}  // namespace salbench::python
