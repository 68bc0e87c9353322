// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/core/parallel.h"

#include <algorithm>
#include <ctime>
#include <optional>
#include <thread>

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "stages/core/check.h"

namespace salbench {
namespace {

using Nanoseconds = std::int64_t;

// counter that the thread's work is charged to; null: none
thread_local std::atomic<Nanoseconds>* helped = nullptr;

Nanoseconds time_of_thread() {
  timespec time = {};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return time.tv_sec * Nanoseconds{1'000'000'000} + time.tv_nsec;
}

// Adds the time of a helping thread to the one it helps.
class Help {
 public:
  explicit Help(std::atomic<Nanoseconds>* whom) : whom_(whom), before_(helped), began_(time_of_thread()) {
    helped = whom;
  }
  Help(const Help&) = delete;
  Help& operator=(const Help&) = delete;
  ~Help() {
    *whom_ += time_of_thread() - began_;
    helped = before_;
  }

 private:
  std::atomic<Nanoseconds>*whom_, *before_;
  Nanoseconds began_;
};

}  // namespace

ProcessorTime::ProcessorTime() : began_(time_of_thread()), around_(helped) { helped = &of_helpers_; }

ProcessorTime::~ProcessorTime() {
  if (around_ != nullptr) *around_ += of_helpers_;
  helped = around_;
}

double ProcessorTime::seconds() const {
  return static_cast<double>(time_of_thread() - began_ + of_helpers_) * 1e-9;
}

void parallel_ranges(std::size_t n, std::size_t grain,
                     const std::function<void(std::size_t first, std::size_t last)>& body) {
  CHECK_LT(0U, grain);
  if (n == 0) return;
  if (n <= grain) return body(0, n);
  const std::size_t ranges = (n - 1) / grain + 1;
  // In the surrounding context, cancellation would end the loop half done, and its result would be stored as
  // complete.
  tbb::task_group_context context(tbb::task_group_context::isolated);
  std::atomic<Nanoseconds>* const whom = helped;
  const std::thread::id owner = std::this_thread::get_id();
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, ranges, 1),
        [&](const tbb::blocked_range<std::size_t>& some) {
          std::optional<Help> help;
          if (whom != nullptr && std::this_thread::get_id() != owner) help.emplace(whom);
          for (std::size_t range = some.begin(); range < some.end(); ++range)
            body(range * grain, std::min((range + 1) * grain, n));
        },
        context);
  });
}

}  // namespace salbench
