// SPDX-License-Identifier: GPL-3.0-or-later
// Scratch folders of the program (io/commands/scratch_folder.h), for what the package writes on the way.
#include <mutex>
#include <optional>

#include "io/commands/scratch_folder.h"
#include "python/computing.h"
#include "python/module.h"

namespace salbench::python {
namespace {

namespace py = pybind11;

// Made when it is entered. The first one of a process removes those of dead processes.
class Scratch {
 public:
  py::object enter() {
    computed([&] {
      static std::once_flag once;
      std::call_once(once, remove_abandoned_scratch);
      folder_.emplace();
    });
    return py::module_::import("os").attr("fsdecode")(py::bytes(folder_->path().string()));
  }
  void exit() {
    computed([&] { folder_.reset(); });
  }

 private:
  std::optional<ScratchFolder> folder_;
};

}  // namespace

void bind_scratch(py::module_& module) {
  py::class_<Scratch>(module, "ScratchFolder")
      .def(py::init<>())
      .def("__enter__", &Scratch::enter)
      .def("__exit__", [](Scratch& folder, const py::args&) { folder.exit(); });
}

}  // namespace salbench::python
