// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of tables.
#pragma once

#include <algorithm>
#include <iterator>
#include <type_traits>
#include <vector>

#include "io/table.h"
#include "pipeline/results/conclusions.h"
#include "stages/core/parallel.h"

namespace salbench {

using Rows = std::vector<std::vector<Cell>>;

// The cells of texts, counts and numbers, of intervals, which are two cells each, and of the cells of others.
template <class... Values>
std::vector<Cell> cells(const Values&... values) {
  std::vector<Cell> row;
  row.reserve(2 * sizeof...(values));  // g++ 14 sees writes past the end in a vector that grows
  const auto add = [&]<class Value>(const Value& value) {
    if constexpr (std::is_same_v<Value, Interval>)
      row.insert(row.end(), {value.low, value.high});
    else if constexpr (std::is_same_v<Value, std::vector<Cell>>)
      row.insert(row.end(), value.begin(), value.end());
    else if constexpr (std::is_integral_v<Value>)
      row.emplace_back(static_cast<std::int64_t>(value));
    else
      row.emplace_back(value);
  };
  (add(values), ...);
  return row;
}

// The rows that `each`(i) makes for i from 0 to n - 1: made in parallel, in their order.
template <class Each>
Rows rows_of_each(std::size_t n, const Each& each) {
  std::vector<Rows> made(n);
  parallel_ranges(n, 1, [&](std::size_t i, std::size_t) { made[i] = each(i); });
  Rows rows;
  for (Rows& some : made) std::ranges::move(some, std::back_inserter(rows));
  return rows;
}

// The rows that `each`(data set, ranked metric, metric) makes of every metric of every data set.
template <class Each>
Rows rows_by_metric(const Conclusions& conclusions, const Each& each) {
  Rows rows;
  for (const DatasetConclusions& dataset : conclusions.datasets)
    std::ranges::move(rows_of_each(dataset.metrics.size(),
                                   [&](std::size_t m) {
                                     return each(dataset.scores, dataset.metrics[m], conclusions.metrics[m]);
                                   }),
                      std::back_inserter(rows));
  return rows;
}

}  // namespace salbench
