// SPDX-License-Identifier: GPL-3.0-or-later
// Computation for Python: without the interpreter's lock, on the requested number of threads.
#pragma once

#include <utility>

#include <pybind11/pybind11.h>
#include <tbb/task_arena.h>

#include "python/log.h"

namespace salbench::python {

// Counts this thread as working. At process exit, static objects are destroyed even if in use, and a
// finalised interpreter ends threads that return to it by unwinding them (until Python 3.14), through
// destructors, which would abort the process. So the interpreter's exit waits for all working threads; a
// thread that starts after that (a daemon) is blocked.
class AtWork {
 public:
  AtWork();
  AtWork(const AtWork&) = delete;
  AtWork& operator=(const AtWork&) = delete;
  ~AtWork();
};

void wait_at_exit();    // registers the wait at exit; nothing is printed
bool is_left_behind();  // at the interpreter's exit: true for all threads but the one that exits

// Runs a function on the calling thread only.
template <class Function>
auto computed(const Function& function) {
  const AtWork counted;
  const LogDelivery afterwards;
  const pybind11::gil_scoped_release others_go_on;
  return function();
}

// Runs a function whose loops over points may use several threads. With one thread the arena starts none, so
// that a forked process may call it.
template <class Function>
auto computed(int threads, const Function& function) {
  return computed([&] {
    tbb::task_arena arena(threads);
    return arena.execute(function);
  });
}

}  // namespace salbench::python
