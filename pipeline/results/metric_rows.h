// SPDX-License-Identifier: GPL-3.0-or-later
// Tables with rows for every metric of every data set.
#pragma once

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/results/conclusions.h"
#include "stages/core/parallel.h"

namespace salbench {

// The rows that `each`(data set, ranked metric, its name) makes of every metric of every data set; metrics in
// parallel, rows in their order.
template <class Each>
Table rows_by_metric(const Conclusions& conclusions, std::vector<std::string> columns, const Each& each) {
  Table table{.columns = std::move(columns), .rows = {}};
  for (const DatasetConclusions& dataset : conclusions.datasets) {
    std::vector<std::vector<std::vector<Cell>>> rows(dataset.metrics.size());
    parallel_ranges(rows.size(), 1, [&](std::size_t m, std::size_t) {
      rows[m] = each(dataset, dataset.metrics[m], conclusions.metrics[m].name);
    });
    for (auto& of_metric : rows) std::ranges::move(of_metric, std::back_inserter(table.rows));
  }
  return table;
}

}  // namespace salbench
