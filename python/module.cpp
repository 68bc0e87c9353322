// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/module.h"

#include <exception>
#include <string>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "io/file.h"
#include "pipeline/config/section.h"
#include "pipeline/run/request.h"
#include "python/arrays.h"
#include "python/computing.h"
#include "python/log.h"
#include "python/texts.h"
#include "stages/core/errors.h"
#include "stages/core/field.h"

namespace salbench::python {
namespace {

namespace py = pybind11;

// Messages may contain file names that are not valid UTF-8.
void raise(py::handle type, const std::string& message) {
  PyErr_SetObject(type.ptr(), file_text(message).ptr());
}

void raise(const char* type, const std::string& message) {
  raise(py::module_::import("salbench.system.errors").attr(type), message);
}

// pybind11 itself translates std::bad_alloc to MemoryError.
void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const UnreadableError& error) {
    raise("UnreadableError", error.what());
  } catch (const InputError& error) {
    raise("InputError", error.what());
  } catch (const UnknownNameError& error) {
    raise(PyExc_KeyError, error.what());
  } catch (const NoConfigurationError& error) {
    raise(PyExc_FileNotFoundError, error.what());
  } catch (const ConfigError& error) {
    raise("InputError", error.what());
  } catch (const StorageError& error) {
    raise("StorageError", error.what());
  } catch (const py::key_error& error) {
    raise(PyExc_KeyError, error.what());
  } catch (const py::value_error& error) {
    raise(PyExc_ValueError, error.what());
  } catch (const std::system_error& error) {
    raise("StorageError", refusal_text(error));
  } catch (const std::logic_error& error) {
    raise(PyExc_RuntimeError, current_defect());
  }
}

}  // namespace

std::string hint(std::string_view name, const std::vector<std::string_view>& known) {
  constexpr std::size_t kFew = 12;  // largest number of names listed in a message
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
  module.attr("simulated_note") = kSimulatedNote;
  module.attr("under_way") = kUnderWay;
  module.attr("a_defect") = a_defect();
  module.attr("largest_coordinate") = kLargestCoordinate;
  module.attr("options") = py::dict();  // options of each function made by `define`
  module.def("did_you_mean", [](const std::string& word, const std::vector<std::string>& known,
                                const std::string& otherwise) {
    return did_you_mean(word, {known.begin(), known.end()}, otherwise);
  });
  module.def("fail_unknown",
             [](const std::string& what, const std::string& name, const std::vector<std::string>& known) {
               fail_unknown(what, name, {known.begin(), known.end()});
             });
  module.def("numbers", [](py::handle values, const std::string& name, std::size_t count) {
    return field(required(values, name.c_str()), count).array;
  });
  module.def("whole_number",
             [](py::handle value, const std::string& name, std::uint64_t low, std::uint64_t high) {
               return whole_number({value, name.c_str()}, low, high);
             });
  module.def("thread_count", [](py::handle value, const std::string& name) {
    return thread_count({value, name.c_str()});
  });
  module.attr("most_threads") = kMostThreads;
  options_are_arguments = true;
  keep_log();
  wait_at_exit();
  bind_cache(module);
  bind_commands(module);
  bind_form(module);
  bind_items(module);
  bind_maintain(module);
  bind_metrics(module);
  bind_models(module);
  bind_plan(module);
  bind_reading(module);
  bind_run(module);
  bind_gaze(module);
  bind_shapes(module);
}

}  // namespace salbench::python
