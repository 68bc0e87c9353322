// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/options.h"

#include <algorithm>

#include <fmt/format.h>

#include "python/module.h"

namespace salbench::python {
namespace {

namespace py = pybind11;

// As JSON, a subset of YAML; NumPy scalars become plain numbers.
std::string yaml_of(py::handle value, const std::string& where) {
  if (py::isinstance<py::str>(value)) return yaml_quoted(std::string(py::str(value)));
  if (py::isinstance<py::bool_>(value) || py::hasattr(value, "dtype"))
    if (const auto item =
            py::hasattr(value, "item") ? value.attr("item")() : py::reinterpret_borrow<py::object>(value);
        py::isinstance<py::bool_>(item))
      return item.cast<bool>() ? "true" : "false";
  if (PyIndex_Check(value.ptr()) != 0) {
    const auto whole = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
    if (!whole) throw py::error_already_set();
    return py::str(whole);
  }
  if (PyNumber_Check(value.ptr()) != 0) {
    const double number = PyFloat_AsDouble(value.ptr());
    if (PyErr_Occurred() != nullptr) throw py::error_already_set();
    return py::repr(py::float_(number));  // as a plain number: NumPy's repr is np.float64(0.3)
  }
  throw py::value_error(fmt::format("{} must be a number, a truth value or a text, not {}", where,
                                    std::string(py::str(py::type::of(value).attr("__name__")))));
}

}  // namespace

Section section_of(const py::dict& keywords, const std::string& function,
                   const std::vector<OptionRow>& options) {
  std::string yaml = "{";
  for (const auto& [keyword, value] : keywords) {
    const auto key = std::string(py::str(keyword));
    if (std::ranges::find(options, key, &OptionRow::name) == options.end()) {
      std::vector<std::string_view> known;
      for (const OptionRow& option : options) known.push_back(option.name);
      throw py::type_error(fmt::format("{}() has no argument '{}'{}", function, key, hint(key, known)));
    }
    yaml += fmt::format("{}{}: {}", yaml.size() > 1 ? ", " : "", key, yaml_of(value, key));
  }
  return Section::from_text(yaml + "}", function);
}

py::list described(const std::vector<OptionRow>& options) {
  py::list rows;
  for (const auto& [name, value, note] : options) rows.append(py::make_tuple(name, value, note));
  return rows;
}

void rethrow(const SectionError& error, const std::string& function) {
  throw py::value_error(fmt::format("{}(): {}", function, error.what_is_wrong));
}

}  // namespace salbench::python
