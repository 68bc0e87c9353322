// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/front.h"

#include <cstddef>
#include <cstdlib>
#include <new>

#include <pybind11/embed.h>

#include "tests/support/toy_data.h"

namespace salbench {
namespace {

// Releases the interpreter's lock, as in a run: callers acquire it. It is never acquired again, nor the
// interpreter finalised: threads may still call.
void start_python() {
  ::setenv("PYTHONPATH", SALBENCH_PACKAGE_FOLDER, 1);
  pybind11::initialize_interpreter();
  pybind11::module_::import("sys").attr("executable") = SALBENCH_TEST_PYTHON;  // for reading processes
  // Not on the heap, where it would count as a leak.
  alignas(pybind11::gil_scoped_release) static std::byte released[sizeof(pybind11::gil_scoped_release)];
  new (released) pybind11::gil_scoped_release;
}

}  // namespace

const Front& front_of_tests() {
  static const Front front = [] {
    start_python();
    return python::python_front();
  }();
  return front;
}

}  // namespace salbench
