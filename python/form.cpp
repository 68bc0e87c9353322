// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/form.h"

#include <cstdint>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "python/arrays.h"
#include "python/computing.h"
#include "python/module.h"
#include "python/texts.h"

namespace salbench::python {
namespace {

template <class T>
Array array_from(const std::string& name, const py::array& given) {
  const auto values = py::array_t<T, py::array::c_style | py::array::forcecast>::ensure(given);
  return {.name = name,
          .shape = {given.shape(), given.shape() + given.ndim()},
          .values = std::vector<T>(values.data(), values.data() + values.size()),
          .unit = "",
          .description = ""};
}

Arrays arrays_from(const py::dict& given) {
  Arrays arrays;
  for (const auto& [key, value] : given) {
    const auto array = py::reinterpret_borrow<py::array>(value);
    const std::string name = file_bytes(key);
    const auto size = array.itemsize();
    const char kind = array.dtype().kind();
    if (kind == 'b' || (kind == 'u' && size == 1))
      arrays.push_back(array_from<std::uint8_t>(name, array));
    else if (kind == 'f')
      arrays.push_back(size == 8 ? array_from<double>(name, array) : array_from<float>(name, array));
    else
      arrays.push_back(size > 4 ? array_from<std::int64_t>(name, array)
                                : array_from<std::int32_t>(name, array));
  }
  return arrays;
}

// Bytes of a file. about: texts by name.
py::bytes bytes_of_form(const py::dict& arrays, const py::dict& about, const std::string& name) {
  ShapeInForm shape = shape_from(arrays, name);
  for (const auto& [key, text] : about) shape.about.emplace_back(file_bytes(key), file_bytes(text));
  const Bytes image = computed([&] { return one_form_image(shape); });
  return {reinterpret_cast<const char*>(image.data()), image.size()};
}

// Arrays and texts by name. None unless one of our programs wrote the bytes.
py::object arrays_of_bytes(const py::bytes& data, const std::string& name) {
  const std::string_view bytes = data;
  const auto shape = computed([&] { return shape_in_form(bytes, name); });
  if (!shape) return py::none();
  py::dict about;
  for (const auto& [key, text] : shape->about) about[file_text(key)] = file_text(text);
  return py::make_tuple(dict_of(*shape), about);
}

}  // namespace

ShapeInForm shape_from(const py::dict& given, const std::string& file) {
  const Arrays arrays = arrays_from(given);
  const py::gil_scoped_release others_run;
  return shape_in_arrays(arrays, file);
}

py::dict dict_of(const ShapeInForm& shape) {
  const auto arrays = std::make_shared<const Arrays>(one_form_arrays(shape));
  py::dict dict;
  for (const Array& array : *arrays) dict[file_text(array.name)] = shown(arrays, array);
  return dict;
}

void bind_form(py::module_& module) {
  module.def("form_image", &bytes_of_form, py::arg("arrays"), py::arg("about"), py::arg("name"));
  module.def("read_form", &arrays_of_bytes, py::arg("data"), py::arg("name"));
  module.def(
      "checked_form",
      [](const py::dict& arrays, const std::string& name) { return dict_of(shape_from(arrays, name)); },
      py::arg("arrays"), py::arg("name"));
}

}  // namespace salbench::python
