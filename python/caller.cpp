// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/caller.h"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include <pybind11/pybind11.h>
#include <unistd.h>

#include "io/commands/process.h"
#include "python/log.h"
#include "stages/core/errors.h"

namespace salbench::python {
namespace {

namespace py = pybind11;

constexpr std::chrono::milliseconds kNowAndThen{100};

// Ends a copy of this process that a function has forked and that has come back from it, by its end or by
// sys.exit(): it has none of the threads of the run, and would wait for them.
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

}  // namespace

void Caller::carry_out(const std::function<void()>& work) {
  Request request{&work};
  std::unique_lock lock(mutex_);
  if (run_ended_) {  // a map that was damaged since: the caller itself asks for it
    lock.unlock();
    const py::gil_scoped_acquire mine;
    return work();
  }
  if (stop_) throw Interrupted("the run was asked to stop");
  requests_.push_back(&request);
  asked_.notify_one();
  ended_.wait(lock, [&] { return request.ended; });
  if (request.thrown) std::rethrow_exception(request.thrown);
}

// Waits without the interpreter's lock. False once the run has ended; the request is null if there is none
// yet.
bool Caller::next(Request*& request) {
  const py::gil_scoped_release others_go_on;
  std::unique_lock lock(mutex_);
  asked_.wait_for(lock, kNowAndThen, [&] { return run_ended_ || !requests_.empty(); });
  request = requests_.empty() ? nullptr : requests_.front();
  if (request != nullptr) requests_.pop_front();
  return request != nullptr || !run_ended_;
}

void Caller::end(Request& request) {
  const std::lock_guard lock(mutex_);
  request.ended = true;
  ended_.notify_all();
}

void Caller::run(const std::function<void()>& the_run, const std::function<void()>& now_and_then) {
  const pid_t process = ::getpid();
  allow_commands();
  std::exception_ptr of_run, of_caller;
  std::thread thread([&] {
    try {
      the_run();
    } catch (...) {
      of_run = std::current_exception();
    }
    const std::lock_guard lock(mutex_);
    run_ended_ = true;
    asked_.notify_one();
  });
  const auto stop_with = [&](std::exception_ptr thrown) {
    if (!of_caller) of_caller = std::move(thrown);
    stop_ = true;
    end_commands();
  };
  auto last = std::chrono::steady_clock::now();
  for (Request* request = nullptr; next(request);) {
    if (request != nullptr) {
      std::exception_ptr thrown;
      try {
        if (stop_) throw Interrupted("the run was asked to stop");
        (*request->work)();
      } catch (...) {
        thrown = std::current_exception();
      }
      if (::getpid() != process) end_copy(thrown);
      request->thrown = thrown;
      try {
        if (thrown) std::rethrow_exception(thrown);
      } catch (const py::error_already_set&) {  // what a function raised was made another error by whoever
                                                // asked for it
        stop_with(thrown);
        request->thrown = std::make_exception_ptr(Interrupted("the run was asked to stop"));
      } catch (...) {  // is for whoever asked
      }
      end(*request);
    }
    deliver_log();
    try {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
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
  deliver_log();
  if (of_caller) std::rethrow_exception(of_caller);
  if (of_run) std::rethrow_exception(of_run);
}

}  // namespace salbench::python
