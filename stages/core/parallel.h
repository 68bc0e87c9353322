// SPDX-License-Identifier: GPL-3.0-or-later
// Loops over the points of one shape, so that a large one keeps every core busy.
#pragma once

#include <cstddef>
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

}  // namespace salbench
