// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/front.h"

#include <memory>
#include <new>
#include <stdexcept>
#include <utility>

#include <pybind11/stl.h>

#include "python/arrays.h"
#include "python/loaded.h"
#include "stages/core/errors.h"

namespace salbench::python {
namespace {

namespace fs = std::filesystem;

constexpr const char* kHooks = "salbench._hooks";

// Throws an error of Python as the type by which the engine tells errors apart.
[[noreturn]] void rethrow(const py::error_already_set& error) {
  const auto is = [&](const char* type) {
    return error.matches(py::module_::import("salbench._errors").attr(type));
  };
  const std::string text = file_bytes(py::str(error.value()));
  if (is("Interrupted")) throw Interrupted(text);
  if (is("StorageError")) throw StorageError(text);
  if (is("InputError")) throw InputError(text);
  if (error.matches(PyExc_MemoryError)) throw std::bad_alloc();
  if (!error.matches(PyExc_Exception)) throw error;  // Ctrl-C, in the thread that called
  throw std::runtime_error(error.what());
}

// Result of a call of Python; `call` turns it into values of C++ while the lock is held.
template <class Call>
auto asked(const Call& call) {
  const py::gil_scoped_acquire mine;
  try {
    return call(py::module_::import(kHooks));
  } catch (const py::error_already_set& error) {
    rethrow(error);
  }
}

// --- listings ---------------------------------------------------------------------------------------------

std::string text_at(const py::handle& row, const char* key) { return file_bytes(row[key]); }

std::vector<std::string> texts_at(const py::handle& row, const char* key) {
  std::vector<std::string> texts;
  for (const py::handle text : row[key]) texts.push_back(file_bytes(text));
  return texts;
}

void read_native(const py::handle& native, DatasetItem& item) {
  item.mesh = text_at(native, "mesh");
  item.picks = texts_at(native, "picks");
  const std::vector<std::string> saliency = texts_at(native, "saliency");
  if (!saliency.empty()) item.saliency = saliency[0];
}

void read_imported(const py::handle& row, DatasetItem& item) {
  ImportedItem imported{.known = {.is_cloud = text_at(row, "kind") == "cloud",
                                  .has_truth = row["truth"].cast<bool>(),
                                  .participants = row["participants"].cast<std::size_t>(),
                                  .viewers = row["viewers"].cast<std::size_t>(),
                                  .recorded = row["recorded"].cast<std::size_t>()},
                        .files = {}};
  for (const py::handle file : row["files"])
    imported.files.push_back({text_at(file, "name"), text_at(file, "path"), text_at(file, "title")});
  item.mesh = imported.files.at(0).path;
  item.imported = std::make_shared<const ImportedItem>(std::move(imported));
}

DatasetItem item_from(const py::handle& row) {
  DatasetItem item{.name = text_at(row, "name"), .category = text_at(row, "category"), .mesh = {}};
  item.view = text_at(row, "view");
  if (!item.view.empty()) item.shape = text_at(row, "shape");
  item.split = text_at(row, "split");
  item.problem = text_at(row, "problem");
  row.contains("native") ? read_native(row["native"], item) : read_imported(row, item);
  return item;
}

Dataset dataset_from(const py::dict& listing) {
  Dataset dataset{.layout = text_at(listing, "layout"),
                  .items = {},
                  .notes = texts_at(listing, "notes"),
                  .splits_where = text_at(listing, "splits_where"),
                  .no_splits = text_at(listing, "no_splits"),
                  .remark = text_at(listing, "remark")};
  for (const py::handle entry : listing["unknown"])
    dataset.unknown.push_back({text_at(entry, "split"), text_at(entry, "name"), text_at(entry, "where")});
  for (const py::handle row : listing["items"]) dataset.items.push_back(item_from(row));
  if (!dataset.items.empty() && dataset.items[0].imported)
    dataset.importer.version = listing["version"].cast<std::int32_t>();
  return dataset;
}

Dataset listed(const fs::path& root, const std::string& layout) {
  return asked([&](const py::module_& hooks) {
    return dataset_from(hooks.attr("listed")(file_text(root.string()), file_text(layout)));
  });
}

// --- files that other programs wrote, and commands --------------------------------------------------------

std::string read(const ReadRequest& request) {
  return asked([&](const py::module_& hooks) {
    py::dict words;
    words["do"] = request.what;
    for (const auto& [key, value] : request.arguments) words[py::str(key)] = file_text(value);
    return hooks.attr("read")(words).cast<std::string>();
  });
}

std::vector<std::string> names_of_maps(const fs::path& file) {
  return asked([&](const py::module_& hooks) {
    std::vector<std::string> names;
    for (const py::handle name : hooks.attr("names_of_maps")(file_text(file.string())))
      names.push_back(file_bytes(name));
    return names;
  });
}

// The last thread of a run that lets go of the object deletes it, whichever thread that is.
std::shared_ptr<py::object> shared(py::object object) {
  return {new py::object(std::move(object)), [](py::object* held) {
            const py::gil_scoped_acquire mine;
            delete held;
          }};
}

FunctionCall command(const CommandLine& line) {
  const std::shared_ptr<py::object> made = asked([&](const py::module_& hooks) {
    py::list depends;
    for (const DependedFile& file : line.depends)
      depends.append(py::make_tuple(file_text(file.name), file_text(file.path.string()), file.digest.hex()));
    return shared(hooks.attr("command")(line.model, file_text(line.line), line.timeout, depends));
  });
  return [made](const FunctionInput& input) {
    return asked([&](const py::module_&) -> ScalarField {
      const auto values =
          field({made->attr("map")(shape_of(input, !input.faces.empty()), input.mapped_faces), "the map"});
      return {values.values.begin(), values.values.end()};
    });
  };
}

// A copy, since the run forgets its values when it likes.
template <class T>
py::array copied(std::span<const T> values) {
  return read_only(moved(std::vector<T>(values.begin(), values.end())));
}

// Without the module nothing is at work. Whoever calls has threads of a run to wait for: nothing is thrown.
void call_hook(const char* name) try {
  const py::dict modules = py::module_::import("sys").attr("modules");
  if (modules.contains(kHooks)) modules[kHooks].attr(name)();
} catch (py::error_already_set& error) {
  error.discard_as_unraisable(name);
}

}  // namespace

Front python_front() {
  return {.list = listed,
          .layouts_that_fit =
              [](const fs::path& root) {
                return asked([&](const py::module_& hooks) {
                  return file_bytes(hooks.attr("layouts_that_fit")(file_text(root.string())));
                });
              },
          .read = read,
          .names_of_maps = names_of_maps,
          .command = command};
}

void allow_hooks() { call_hook("begin"); }
void end_hooks() { call_hook("end_all"); }
void finish_hooks() { call_hook("finish"); }

py::object shape_of(const FunctionInput& input, bool reads_faces) {
  py::object faces = py::none(), normals = py::none(), fpfh = py::none(), source = py::none();
  if (reads_faces) faces = copied<Triangle>(input.faces);
  if (input.normals != nullptr) normals = copied<Vec3>(*input.normals);
  if (input.fpfh != nullptr) fpfh = read_only(moved(std::vector<float>(input.fpfh->values), {-1, kFpfhBins}));
  if (!input.source.empty()) source = file_text(input.source);
  return py::module_::import("salbench._shape")
      .attr("Shape")(file_text(input.item), copied<Vec3>(input.points), faces, normals, fpfh,
                     py::arg("source") = source);
}

}  // namespace salbench::python
