// SPDX-License-Identifier: GPL-3.0-or-later
// Parallel loops over the points of one shape, so that a large shape uses every core.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>

namespace salbench {

// Points per range if the work per point is small.
inline constexpr std::size_t kPointGrain = 1024;

// Calls body(first, last) for the ranges [0, grain), [grain, 2 grain) ... of [0, n): the same ranges for any
// number of threads, in any order, concurrently. Idle threads help; none of them takes up other work before
// the loop has ended, and the loop completes even if the surrounding run is being cancelled. Rethrows an
// exception of a body; if there are several, any one of them.
void parallel_ranges(std::size_t n, std::size_t grain,
                     const std::function<void(std::size_t first, std::size_t last)>& body);

// Processor time of the constructing thread, and of the threads that help it in parallel_ranges(). Waiting
// for a lock, a disk or a core does not count.
class ProcessorTime {
 public:
  ProcessorTime();
  ProcessorTime(const ProcessorTime&) = delete;
  ProcessorTime& operator=(const ProcessorTime&) = delete;
  ~ProcessorTime();

  double seconds() const;  // since construction; called by the same thread

 private:
  std::int64_t began_;                        // ns
  std::atomic<std::int64_t> of_helpers_ = 0;  // ns
  std::atomic<std::int64_t>* around_;         // enclosing counter, which includes this time; null: none
};

}  // namespace salbench
