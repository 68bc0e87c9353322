// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/computing.h"

#include <atomic>
#include <chrono>
#include <thread>

#include <pthread.h>
#include <unistd.h>

namespace salbench::python {
namespace {

namespace py = pybind11;

std::atomic<int> at_work = 0;
std::atomic<bool> ends = false;
std::atomic<std::thread::id> last;  // thread in which the interpreter ends; it may still compute
thread_local int depth = 0;         // nesting: functions called by a run may compute too

// Exit handlers of modules imported earlier may still follow.
void end() {
  last = std::this_thread::get_id();
  ends = true;
  const py::gil_scoped_release others_come_back;
  while (at_work > 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

}  // namespace

AtWork::AtWork() {
  if (depth++ > 0) return;
  if (is_left_behind()) {
    const py::gil_scoped_release others_go_on;
    for (;;) ::pause();
  }
  ++at_work;
}

AtWork::~AtWork() {
  if (--depth == 0) --at_work;
}

bool is_left_behind() { return ends && last.load() != std::this_thread::get_id(); }

void wait_at_exit() {
  ::pthread_atfork(nullptr, nullptr, [] { at_work = 0; });  // worker threads do not exist in the child
  py::module_::import("atexit").attr("register")(py::cpp_function(end));
}

}  // namespace salbench::python
