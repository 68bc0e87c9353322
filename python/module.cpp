// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/module.h"

#include <exception>
#include <filesystem>
#include <string>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "pipeline/config/section.h"
#include "pipeline/package/package.h"
#include "python/arrays.h"
#include "python/computing.h"
#include "python/log.h"
#include "stages/core/errors.h"

namespace salbench::python {
namespace {

namespace py = pybind11;

void raise(const char* type, const std::exception& error) {
  PyErr_SetString(py::module_::import("salbench._errors").attr(type).ptr(), error.what());
}

// std::bad_alloc is a MemoryError, and what an array says is a ValueError: pybind11 has these.
void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const InputError& error) {
    raise("InputError", error);
  } catch (const UnknownNameError& error) {
    PyErr_SetString(PyExc_KeyError, error.what());
  } catch (const ConfigError& error) {
    raise("InputError", error);
  } catch (const StorageError& error) {
    raise("StorageError", error);
  } catch (const std::logic_error& error) {
    PyErr_SetString(PyExc_RuntimeError, current_defect().c_str());
  }
}

// What a run starts to list and import data sets: this interpreter, and this package.
void use_own_package() {
  const auto sys = py::module_::import("sys");
  const py::object executable = sys.attr("executable"), modules = sys.attr("modules");
  if (!executable.is_none() && py::len(executable) > 0 && modules.contains("salbench")) {
    const auto folder = py::cast<std::string>(modules["salbench"].attr("__path__")[py::int_(0)]);
    use_package(py::cast<std::string>(executable), std::filesystem::path(folder).parent_path());
  }
}

}  // namespace

std::string hint(std::string_view name, const std::vector<std::string_view>& known) {
  constexpr std::size_t kFew = 12;  // names that a message can list
  const bool few = !known.empty() && known.size() <= kFew;
  const std::string text =
      did_you_mean(name, known, few ? fmt::format("there are {}", fmt::join(known, ", ")) : "");
  return text.empty() ? text : "; " + text;
}

void fail_unknown(std::string_view what, std::string_view name, const std::vector<std::string_view>& known) {
  throw py::key_error(fmt::format("there is no {} '{}'{}", what, name, hint(name, known)));
}

PYBIND11_MODULE(_core, module) {
  py::register_exception_translator(translate);
  module.attr("version") = SALBENCH_VERSION;
  module.attr("options") = py::dict();  // of each function that `define` makes
  module.def("did_you_mean", [](const std::string& word, const std::vector<std::string>& known,
                                const std::string& otherwise) {
    return did_you_mean(word, {known.begin(), known.end()}, otherwise);
  });
  module.def("fail_unknown",
             [](const std::string& what, const std::string& name, const std::vector<std::string>& known) {
               fail_unknown(what, name, {known.begin(), known.end()});
             });
  module.def("whole_number",
             [](py::handle value, const std::string& name, std::uint64_t low, std::uint64_t high) {
               return whole_number({value, name.c_str()}, low, high);
             });
  options_are_arguments = true;
  use_own_package();
  keep_log();
  wait_at_exit();
  bind_cache(module);
  bind_data(module);
  bind_datasets(module);
  bind_metrics(module);
  bind_models(module);
  bind_run(module);
  bind_scratch(module);
  bind_shapes(module);
}

}  // namespace salbench::python
