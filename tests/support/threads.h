// SPDX-License-Identifier: GPL-3.0-or-later
// Computations on 1, 2 and 4 threads, and in several at once.
#pragma once

#include <future>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

namespace salbench {

// Expects equal bytes each time, and returns them.
template <class Compute>
auto same_on_any_number_of_threads(const Compute& compute) {
  const auto on = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return compute();
  };
  auto one = on(1);
  for (const std::size_t threads : {2U, 4U}) EXPECT_TRUE(on(threads) == one) << threads << " threads";
  return one;
}

// Expects of four threads at once what one computes alone, and returns it.
template <class Compute>
auto same_in_threads_at_once(const Compute& compute) {
  auto alone = compute();
  std::vector<std::future<decltype(alone)>> others;
  for (int k = 0; k < 4; ++k) others.push_back(std::async(std::launch::async, compute));
  for (auto& other : others) EXPECT_TRUE(other.get() == alone);
  return alone;
}

}  // namespace salbench
