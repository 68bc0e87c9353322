// SPDX-License-Identifier: GPL-3.0-or-later
// Loops over the points of one shape, so that a large one keeps every core busy.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>

namespace salbench {

// Points of a range where one point is little work.
inline constexpr std::size_t kPointGrain = 1024;

// Calls body(first, last) for the ranges [0, grain), [grain, 2 grain) ... of [0, n): the same ranges whatever
// the number of threads, in any order, several at a time. Threads help that have nothing else to do; none of
// them takes up other work before the loop is done, and the loop is done even if the run around it is being
// cancelled. An exception of a body is thrown on; which one, if there are several, is not determined.
void parallel_ranges(std::size_t n, std::size_t grain,
                     const std::function<void(std::size_t first, std::size_t last)>& body);

// Processor time of the thread that makes it, and of the threads that help it in parallel_ranges(). What a
// thread waits, for a lock, a disk or a core, is no processor time.
class ProcessorTime {
 public:
  ProcessorTime();
  ProcessorTime(const ProcessorTime&) = delete;
  ProcessorTime& operator=(const ProcessorTime&) = delete;
  ~ProcessorTime();

  double seconds() const;  // since it was made; asked for by the same thread

 private:
  std::int64_t began_;                        // ns
  std::atomic<std::int64_t> of_helpers_ = 0;  // ns
  std::atomic<std::int64_t>* around_;         // whose time this one is part of; null: nobody's
};

}  // namespace salbench
