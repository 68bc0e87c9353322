// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/items.h"

#include <string>
#include <utility>
#include <vector>

#include <pybind11/stl.h>

#include "pipeline/inputs/listing.h"
#include "python/computing.h"
#include "python/module.h"
#include "python/texts.h"

namespace salbench::python {
namespace {

namespace py = pybind11;

std::string text_of(py::handle object, const char* name) { return file_bytes(object.attr(name)); }

std::vector<std::string> texts_of(py::handle object, const char* name) {
  std::vector<std::string> texts;
  for (const py::handle text : object.attr(name)) texts.push_back(file_bytes(text));
  return texts;
}

// Keyword arguments of an Item.
py::dict fields_of(const Item& item) {
  py::dict fields;
  fields["name"] = file_text(item.name);
  fields["files"] = file_texts({item.file});
  fields["category"] = file_text(item.category);
  fields["split"] = file_text(item.split);
  fields["kind"] = !item.is_in_form() ? "" : item.is_cloud ? "cloud" : "mesh";
  fields["truth"] = item.is_in_form() ? item.with_truth : item.has_truth();
  fields["participants"] = item.is_in_form() ? item.participants : item.picks.size();
  fields["viewers"] = item.viewers;
  fields["recorded"] = item.recorded;
  fields["shape"] = file_text(item.shape);
  fields["view"] = file_text(item.view);
  fields["saliency"] = file_text(item.saliency);
  fields["picks"] = file_texts(item.picks);
  return fields;
}

// Layout name and Listing fields, including items, of a layout that C++ lists.
py::tuple native_listing(const std::string& layout, const std::string& root) {
  const salbench::Dataset found = computed(1, [&] { return find_dataset(root, layout); });
  py::list items;
  for (const Item& item : found.items) items.append(fields_of(item));
  py::dict listing;
  listing["items"] = items;
  listing["notes"] = file_texts(found.notes);
  listing["splits_where"] = file_text(found.splits_where);
  listing["remark"] = file_text(found.remark);
  return py::make_tuple(file_text(found.layout), listing);
}

// Layout that "automatic" selects.
py::str automatic(const std::string& root) {
  return file_text(computed(1, [&] { return automatic_layout(data_folder(root)); }));
}

// Indices of the chosen items. An empty split means all.
std::vector<std::size_t> chosen_items(const py::object& listing, const py::object& wanted,
                                      const std::string& split) {
  salbench::Dataset found;
  found.splits_where = text_of(listing, "splits_where");
  found.no_splits = text_of(listing, "no_splits");
  for (const py::handle given : listing.attr("items")) {
    found.items.push_back(item_from(given, ReadBy::front));
    found.items.back().key = std::to_string(found.items.size() - 1);  // index in the listing
  }
  select_items(found, choice_of(wanted), split);
  std::vector<std::size_t> chosen;
  for (const Item& item : found.items) chosen.push_back(std::stoul(item.key));
  return chosen;
}

}  // namespace

Item item_from(py::handle given, ReadBy read_by) {
  Item item{.name = text_of(given, "name"),
            .category = text_of(given, "category"),
            .split = text_of(given, "split"),
            .view = text_of(given, "view"),
            .problem = text_of(given, "problem"),
            .read_by = read_by,
            .file = {}};
  if (!item.view.empty()) item.shape = text_of(given, "shape_name");
  std::vector<std::string> files = texts_of(given, "files");
  item.file = files.empty() ? item.name : files[0];
  if (read_by == ReadBy::salbench) {
    item.saliency = text_of(given, "saliency");
    item.picks = texts_of(given, "picks");
    return item;
  }
  if (read_by == ReadBy::front) item.files = std::move(files);
  item.is_cloud = text_of(given, "kind") == "cloud";
  item.with_truth = given.attr("truth").cast<bool>();
  item.participants = given.attr("participants").cast<std::size_t>();
  item.viewers = given.attr("viewers").cast<std::size_t>();
  item.recorded = given.attr("recorded").cast<std::size_t>();
  return item;
}

ItemChoice choice_of(py::handle items) {
  if (items.is_none()) return {};
  if (py::isinstance<py::bytes>(items)) return items.cast<std::string>();
  return ItemChoice(items.cast<std::vector<std::string>>());
}

Dataset dataset_from(py::handle dataset, py::handle listing) {
  const bool has_read = dataset.attr("has_read").cast<bool>();
  Dataset found{.layout = text_of(dataset, "name"),
                .items = {},
                .notes = texts_of(listing, "notes"),
                .splits_where = text_of(listing, "splits_where"),
                .no_splits = text_of(listing, "no_splits"),
                .remark = text_of(listing, "remark")};
  for (const py::handle row : listing.attr("unknown")) {
    const auto [split, item, where] = row.cast<std::tuple<py::object, py::object, py::object>>();
    found.unknown.push_back({file_bytes(split), file_bytes(item), file_bytes(where)});
  }
  for (const py::handle item : listing.attr("items")) {
    found.items.push_back(item_from(item, has_read ? ReadBy::front : ReadBy::salbench));
    if (has_read) found.items.back().key = file_bytes(dataset.attr("key_of")(item));
  }
  if (has_read) found.version = dataset.attr("version").cast<std::int32_t>();
  return found;
}

void bind_items(py::module_& module) {
  module.def("automatic_layout", &automatic, py::arg("root"));
  module.def("native_listing", &native_listing, py::arg("layout"), py::arg("root"));
  module.def("chosen_items", &chosen_items, py::arg("listing"), py::arg("items"), py::arg("split"));
}

}  // namespace salbench::python
