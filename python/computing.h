// SPDX-License-Identifier: GPL-3.0-or-later
// Computing for Python: without the interpreter's lock, on as many threads as the caller has asked for.
#pragma once

#include <utility>

#include <pybind11/pybind11.h>
#include <tbb/task_arena.h>

#include "python/log.h"

namespace salbench::python {

inline constexpr int kMostThreads = 1024;

// A function that works on one thread whatever it is called with.
template <class Function>
auto computed(const Function& function) {
  const LogDelivery afterwards;
  const pybind11::gil_scoped_release others_go_on;
  return function();
}

// A function whose loops over the points may have help. An arena of one thread starts none, so that a process
// that was forked may call it.
template <class Function>
auto computed(int threads, const Function& function) {
  const LogDelivery afterwards;
  const pybind11::gil_scoped_release others_go_on;
  tbb::task_arena arena(threads);
  return arena.execute(function);
}

}  // namespace salbench::python
