// SPDX-License-Identifier: GPL-3.0-or-later
// Computing for Python: without the interpreter's lock, on as many threads as the caller has asked for.
#pragma once

#include <utility>

#include <pybind11/pybind11.h>
#include <tbb/task_arena.h>

#include "python/log.h"

namespace salbench::python {

// This thread counts as at work. What lives as long as the process is destroyed at its end, whoever uses it,
// and an interpreter that has ended ends threads that come back to it, by unwinding them (until Python 3.14):
// through destructors, which would abort the process. So the end of the interpreter waits for all that are at
// work; a thread that begins after that, a daemon, stays where it is.
class AtWork {
 public:
  AtWork();
  AtWork(const AtWork&) = delete;
  AtWork& operator=(const AtWork&) = delete;
  ~AtWork();
};

void wait_at_exit();    // from now on; says nothing
bool is_left_behind();  // once the interpreter ends: every thread but the one that it ends in

// A function that works on one thread whatever it is called with.
template <class Function>
auto computed(const Function& function) {
  const AtWork counted;
  const LogDelivery afterwards;
  const pybind11::gil_scoped_release others_go_on;
  return function();
}

// A function whose loops over the points may have help. An arena of one thread starts none, so that a process
// that was forked may call it.
template <class Function>
auto computed(int threads, const Function& function) {
  return computed([&] {
    tbb::task_arena arena(threads);
    return arena.execute(function);
  });
}

}  // namespace salbench::python
