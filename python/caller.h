// SPDX-License-Identifier: GPL-3.0-or-later
// The thread that called a run is the only one that executes Python while the run continues in its own
// threads: user functions run in the thread they were created in, and Ctrl-C arrives where Python expects it.
// Python's queue and Future are unsuitable: Ctrl-C may arrive between any two of their lines, leaving threads
// of the run waiting for an answer.
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
  // Called from a thread of the run, without the interpreter's lock. Returns after the caller has carried out
  // the task, and throws what it threw. The time until the task begins counts as waiting. Throws Interrupted
  // once the run is to stop. After the run, carries out the task directly.
  void carry_out(const std::function<void()>& work);

  // Called by the caller, with the interpreter's lock. Runs `the_run` in a thread until it ends, carries out
  // its tasks meanwhile, and calls `now_and_then` about ten times a second. If Python has a pending error, as
  // after Ctrl-C, or `now_and_then` throws, the run is asked to stop, and the error is thrown afterwards.
  // Otherwise throws what the run threw.
  void run(const std::function<void()>& the_run, const std::function<void()>& now_and_then);

  const std::atomic<bool>& stop() const { return stop_; }

 private:
  void answer(const std::function<void()>& work);
  bool next(std::optional<Task>& task);
  void stop_with(std::exception_ptr thrown);

  void wake() const;

  std::mutex mutex_;
  Descriptor waits_{-1}, wakes_{-1};  // ends of a pipe: writing to it wakes the caller, as signals do
  std::deque<Task> asked_;
  bool run_ended_ = false;
  std::atomic<bool> stop_ = false;
  std::exception_ptr of_caller_;
};

}  // namespace salbench::python
