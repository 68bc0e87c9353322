// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/caller.h"

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <system_error>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <pybind11/pybind11.h>
#include <unistd.h>

#include "pipeline/engine/resolver.h"
#include "python/computing.h"
#include "python/front.h"
#include "python/log.h"
#include "stages/core/errors.h"

namespace salbench::python {
namespace {

namespace py = pybind11;

constexpr std::chrono::milliseconds kNowAndThen{100};
constexpr const char* kStopped = "the run was asked to stop";

// Ends a child process that a function forked and that returned from it, or left it by sys.exit(): it lacks
// the threads of the run, and would wait for them.
[[noreturn]] void end_copy(const std::exception_ptr& thrown) {
  int status = EXIT_FAILURE;
  try {
    if (thrown) std::rethrow_exception(thrown);
    status = EXIT_SUCCESS;
  } catch (const py::error_already_set& error) {
    const py::object code =
        error.matches(PyExc_SystemExit) ? py::object(error.value().attr("code")) : py::object(py::str());
    if (code.is_none() || py::isinstance<py::int_>(code)) ::_exit(code.is_none() ? 0 : code.cast<int>());
  } catch (...) {
  }
  std::fputs(
      "salbench: a process that a function has forked came back from it, and was ended; "
      "let it end with os._exit()\n",
      stderr);
  ::_exit(status);
}

// Wakes the caller at once when a signal arrives that this thread handles, not a tenth of a second later.
class WokenBySignals {
 public:
  explicit WokenBySignals(int wakes) {
    const auto threading = py::module_::import("threading");
    is_ours_ = threading.attr("current_thread")().is(threading.attr("main_thread")());
    if (is_ours_) before_ = set(wakes);
  }
  WokenBySignals(const WokenBySignals&) = delete;
  WokenBySignals& operator=(const WokenBySignals&) = delete;
  ~WokenBySignals() {
    if (is_ours_) set(before_);
  }

 private:
  // Returns the previous value.
  static int set(int wakes) {
    return py::module_::import("signal")
        .attr("set_wakeup_fd")(wakes, py::arg("warn_on_full_buffer") = false)
        .cast<int>();
  }

  bool is_ours_ = false;
  int before_ = -1;
};

}  // namespace

void Caller::carry_out(const std::function<void()>& work) {
  const Clock::time_point asked = Clock::now();
  Clock::time_point begun = asked;
  Task task([&] {
    begun = Clock::now();
    answer(work);
  });
  std::future<void> answered = task.get_future();
  std::unique_lock lock(mutex_);
  if (run_ended_) {  // a map damaged since the run, requested by the caller itself
    lock.unlock();
    const py::gil_scoped_acquire mine;
    return work();
  }
  asked_.push_back(std::move(task));
  wake();
  lock.unlock();
  answered.wait();
  note_waiting(begun - asked);
  answered.get();
}

// Callers translate exceptions of user functions; any Python exception that is left ends the run.
void Caller::answer(const std::function<void()>& work) {
  const pid_t process = ::getpid();
  std::exception_ptr thrown;
  try {
    if (stop_) throw Interrupted(kStopped);
    work();
  } catch (...) {
    thrown = std::current_exception();
  }
  if (::getpid() != process) end_copy(thrown);
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const py::error_already_set&) {
    stop_with(thrown);
    throw Interrupted(kStopped);
  }
}

void Caller::stop_with(std::exception_ptr thrown) {
  if (!of_caller_) of_caller_ = std::move(thrown);
  stop_ = true;
  end_hooks();
}

// One pending byte suffices.
void Caller::wake() const { static_cast<void>(::write(wakes_.get(), "", 1)); }

// Waits without the interpreter's lock. False once the run has ended; may return without a task.
bool Caller::next(std::optional<Task>& task) {
  const py::gil_scoped_release others_go_on;
  const bool waits = [&] {
    const std::lock_guard lock(mutex_);
    return !run_ended_ && asked_.empty();
  }();
  pollfd woken{waits_.get(), POLLIN, 0};
  ::poll(&woken, 1, waits ? static_cast<int>(kNowAndThen.count()) : 0);
  for (char read[64]; ::read(waits_.get(), read, sizeof read) == sizeof read;) {
  }
  const std::lock_guard lock(mutex_);
  task.reset();
  if (asked_.empty()) return !run_ended_;
  task = std::move(asked_.front());
  asked_.pop_front();
  return true;
}

void Caller::run(const std::function<void()>& the_run, const std::function<void()>& now_and_then) {
  const AtWork counted;
  allow_hooks();
  run_ended_ = false;
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC | O_NONBLOCK) != 0)
    throw std::system_error(errno, std::generic_category(), "no pipe for a run");
  waits_ = Descriptor(ends[0]);
  wakes_ = Descriptor(ends[1]);
  const WokenBySignals at_once(wakes_.get());
  Task whole(the_run);
  std::future<void> ended = whole.get_future();
  std::thread thread([&] {
    whole();
    const std::lock_guard lock(mutex_);
    run_ended_ = true;
    wake();
  });
  auto last = std::chrono::steady_clock::now();
  for (std::optional<Task> task; next(task);) {
    if (task) (*task)();
    deliver_log();
    try {
      if (is_left_behind() && !stop_) PyErr_SetNone(PyExc_SystemExit);  // in a daemon thread
      if (PyErr_Occurred() != nullptr || PyErr_CheckSignals() != 0 || Py_MakePendingCalls() != 0)
        throw py::error_already_set();
      if (const auto now = std::chrono::steady_clock::now(); !stop_ && now - last >= kNowAndThen) {
        last = now;
        now_and_then();
      }
    } catch (const py::error_already_set&) {
      stop_with(std::current_exception());
    }
  }
  {
    const py::gil_scoped_release others_go_on;
    thread.join();
  }
  finish_hooks();
  deliver_log();
  if (of_caller_) std::rethrow_exception(std::exchange(of_caller_, nullptr));
  ended.get();
  now_and_then();  // for the last task
}

}  // namespace salbench::python
