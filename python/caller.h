// SPDX-License-Identifier: GPL-3.0-or-later
// The thread that called a run, which alone runs Python while the run goes on in threads of its own:
// functions of the user see the thread that they were made in, and Ctrl-C arrives where Python looks for it.
// Not queue and Future of Python: Ctrl-C may come between any two lines there, and leaves threads of the run
// that wait for an answer.
#pragma once

#include <atomic>
#include <deque>
#include <exception>
#include <functional>
#include <future>
#include <mutex>
#include <optional>

#include "io/descriptor.h"

namespace salbench::python {

class Caller {
  using Task = std::packaged_task<void()>;

 public:
  // From a thread of the run, without the interpreter's lock: returns when the caller has carried it out, and
  // throws what it threw. The time until the caller begins is noted as waiting. Throws Interrupted once the
  // run is to stop. After the run it is carried out at once.
  void carry_out(const std::function<void()>& work);

  // By the caller, with the interpreter's lock, until the run, in a thread of its own, has ended: carries out
  // what it is asked for, and calls `now_and_then` some ten times a second. Once Python has an error pending,
  // as after Ctrl-C, or `now_and_then` throws one, the run is asked to stop; the error is thrown when it has.
  // Throws what the run threw.
  void run(const std::function<void()>& the_run, const std::function<void()>& now_and_then);

  const std::atomic<bool>& stop() const { return stop_; }

 private:
  void answer(const std::function<void()>& work);
  bool next(std::optional<Task>& task);
  void stop_with(std::exception_ptr thrown);

  void wake() const;

  std::mutex mutex_;
  Descriptor waits_{-1}, wakes_{-1};  // ends of a pipe: who writes into it wakes the caller, as signals do
  std::deque<Task> asked_;
  bool run_ended_ = false;
  std::atomic<bool> stop_ = false;
  std::exception_ptr of_caller_;
};

}  // namespace salbench::python
