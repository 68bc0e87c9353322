// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/front.h"

#include <memory>
#include <new>
#include <stdexcept>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "python/arrays.h"
#include "python/form.h"
#include "python/items.h"
#include "python/texts.h"
#include "stages/core/errors.h"

namespace salbench::python {
namespace {

namespace fs = std::filesystem;

constexpr const char* kHooks = "salbench.runs.hooks";

// Rethrows a Python error as the engine's corresponding type.
[[noreturn]] void rethrow(const py::error_already_set& error) {
  const auto is = [&](const char* type) {
    return error.matches(py::module_::import("salbench.system.errors").attr(type));
  };
  const std::string text = file_bytes(py::str(error.value()));
  if (is("Interrupted")) throw Interrupted(text);
  if (is("StorageError")) throw StorageError(text);
  if (is("InputError")) throw InputError(text);
  if (error.matches(PyExc_MemoryError)) throw std::bad_alloc();
  if (!error.matches(PyExc_Exception)) throw error;  // Ctrl-C in the calling thread
  throw std::runtime_error(error.what());
}

// Result of a call to Python; `call` converts it to C++ values while the lock is held.
template <class Call>
auto asked(const Call& call) {
  const py::gil_scoped_acquire mine;
  try {
    return call(py::module_::import(kHooks));
  } catch (const py::error_already_set& error) {
    rethrow(error);
  }
}

// --- data sets, and files of other programs ---------------------------------------------------------------

// Whichever thread releases the object last deletes it, with the interpreter's lock.
std::shared_ptr<py::object> shared(py::object object) {
  return {new py::object(std::move(object)), [](py::object* held) {
            const py::gil_scoped_acquire mine;
            delete held;
          }};
}

// Keeps the data set and its listing alive while they may be read.
ReadItem reader_of(py::object dataset, const py::object& listing) {
  py::dict items;
  for (const py::handle item : listing.attr("items")) items[item.attr("name")] = item;
  return [kept = shared(py::make_tuple(std::move(dataset), std::move(items)))](const Item& item) {
    return asked([&](const py::module_& hooks) {
      const auto [of, by_name] = kept->cast<std::pair<py::object, py::dict>>();
      const auto [arrays, remark] =
          hooks.attr("read")(of, by_name[file_text(item.name)]).cast<std::pair<py::dict, py::str>>();
      ShapeInForm shape = shape_from(arrays, item.file);
      shape.remark = file_bytes(remark);
      return shape;
    });
  };
}

// found: pair of data set and listing.
Dataset dataset_read_by_python(const py::object& found) {
  const auto [of, listing] = found.cast<std::pair<py::object, py::object>>();
  Dataset dataset = dataset_from(of, listing);
  if (dataset.version > 0) dataset.read = reader_of(of, listing);
  return dataset;
}

Dataset listed(const fs::path& root, const std::string& layout) {
  return asked([&](const py::module_& hooks) {
    return dataset_read_by_python(hooks.attr("listed")(file_text(root.string()), file_text(layout)));
  });
}

// Coordinates are NaN for rows without a position.
PointCloud read_cloud(const fs::path& file) {
  return asked([&](const py::module_& hooks) {
    const auto [points, normals, viewpoint] = hooks.attr("read_cloud")(file_text(file.string()))
                                                  .cast<std::tuple<py::object, py::object, py::object>>();
    PointCloud cloud{.points = vectors({points, "points"}).copy()};
    cloud.normals = vectors({normals, "normals"}).copy();
    if (!viewpoint.is_none()) cloud.viewpoint = place({viewpoint, "viewpoint"});
    return cloud;
  });
}

ShapeInForm read_form(const fs::path& file, const std::string& shape) {
  return asked([&](const py::module_& hooks) {
    const py::object arrays = hooks.attr("read_form")(file_text(file.string()), file_text(shape));
    return shape_from(arrays, file.string());
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

ScalarField read_map(const fs::path& file, const std::string& name) {
  return asked([&](const py::module_& hooks) -> ScalarField {
    return field({hooks.attr("read_map")(file_text(file.string()), file_text(name)), "the map"}).copy();
  });
}

// --- commands ---------------------------------------------------------------------------------------------

FunctionCall command(const CommandLine& line) {
  const std::shared_ptr<py::object> made = asked([&](const py::module_& hooks) {
    py::list depends;
    for (const DependedFile& file : line.depends)
      depends.append(py::make_tuple(file_text(file.name), file_text(file.path.string()), file.digest.hex()));
    return shared(hooks.attr("command")(line.model, file_text(line.line), line.timeout, depends));
  });
  return [made](const FunctionInput& input) {
    return asked([&](const py::module_&) -> ScalarField {
      const py::object map =
          made->attr("map")(python::shape_of(input, !input.faces.empty()), input.mapped_faces);
      return map_values({map, "the map"}).copy();
    });
  };
}

// Copies, since the run may drop its values at any time.
template <class T>
py::array copied(std::span<const T> values) {
  return read_only(moved(std::vector<T>(values.begin(), values.end())));
}

// Does nothing unless the module is loaded as a whole. Never throws: the caller still has to wait for threads
// of a run.
void call_hook(const char* name) try {
  const py::dict modules = py::module_::import("sys").attr("modules");
  if (modules.contains(kHooks) && py::hasattr(modules[kHooks], name)) modules[kHooks].attr(name)();
} catch (py::error_already_set& error) {
  error.discard_as_unraisable(name);
}

}  // namespace

Front python_front() {
  return {.dataset = {},
          .list = listed,
          .layouts_that_fit =
              [](const fs::path& root) {
                return asked([&](const py::module_& hooks) {
                  return file_bytes(hooks.attr("layouts_that_fit")(file_text(root.string())));
                });
              },
          .read_cloud = read_cloud,
          .read_form = read_form,
          .names_of_maps = names_of_maps,
          .read_map = read_map,
          .command = command};
}

Front python_front(py::handle settings) {
  Front front = python_front();
  if (py::object dataset = settings.attr("dataset"); !dataset.is_none())
    front.dataset = [given = shared(std::move(dataset))] {
      return asked(
          [&](const py::module_& hooks) { return dataset_read_by_python(hooks.attr("listed_of")(*given)); });
    };
  return front;
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
  return py::module_::import("salbench.shapes.shape")
      .attr("Shape")(file_text(input.item), copied<Vec3>(input.points), faces, normals, fpfh,
                     py::arg("source") = source);
}

}  // namespace salbench::python
