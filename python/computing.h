// SPDX-License-Identifier: GPL-3.0-or-later
// Computing for Python: without the interpreter's lock, on as many threads as the caller has asked for.
#pragma once

#include <utility>

#include <pybind11/pybind11.h>
#include <unistd.h>
#include <tbb/task_arena.h>

#include "python/log.h"

namespace salbench::python {

inline constexpr int kMostThreads = 1024;

// The interpreter goes on without this thread. Once it shuts down it ends threads that come back, by unwinding them
// (until Python 3.14): through destructors, which would abort the process, and through frames that hold arrays. Such a
// thread stays here instead, and ends with the process.
class OthersGoOn {
 public:
  OthersGoOn() : state_(PyEval_SaveThread()) {}
  OthersGoOn(const OthersGoOn&) = delete;
  OthersGoOn& operator=(const OthersGoOn&) = delete;
  ~OthersGoOn() {
    try {
      PyEval_RestoreThread(state_);
    } catch (...) {
      for (;;) pause();
    }
  }

 private:
  PyThreadState* state_;
};

// A function that works on one thread whatever it is called with.
template <class Function>
auto computed(const Function& function) {
  const LogDelivery afterwards;
  const OthersGoOn unlocked;
  return function();
}

// A function whose loops over the points may have help. An arena of one thread starts none, so that a process
// that was forked may call it.
template <class Function>
auto computed(int threads, const Function& function) {
  const LogDelivery afterwards;
  const OthersGoOn unlocked;
  tbb::task_arena arena(threads);
  return arena.execute(function);
}

}  // namespace salbench::python
