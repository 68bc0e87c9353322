// SPDX-License-Identifier: GPL-3.0-or-later
// Exact search for the histograms nearest to each in chi-square distance, sum (a - b)^2 / (a + b), in O(n)
// memory.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "stages/core/types.h"
#include "stages/models/chi2_kernel.h"
#include "stages/models/chi2_nearest.h"
#include "stages/models/chi2_table.h"

namespace salbench {

class Chi2Search {
 public:
  // Leaves out bins that are 0 in every histogram. Throws InputError if a value is negative, not finite, or
  // so large that its square overflows. Each histogram is compared with those of `references`, ascending
  // indices, or if there are none with all.
  explicit Chi2Search(const Descriptors& descriptors, std::span<const std::int32_t> references = {});

  std::size_t size() const { return table_.size(); }           // histograms that each is compared with
  std::span<const std::size_t> bins() const { return bins_; }  // used ones, ascending
  float beyond_all() const { return beyond_all_; }             // more than any distance
  const Chi2Table& table() const { return table_; }
  const chi2_kernel::Kernel& kernel() const { return kernel_; }

  // All histograms; those beside each other resemble each other. A row has the used bins.
  std::span<const std::int32_t> queries() const { return queries_; }
  const float* row(std::size_t query) const { return &rows_[query * bins_.size()]; }

  // 1 <= k <= size().
  Chi2Nearest nearest(std::size_t k) const;

  // Calls visit(i, nearest) once for each histogram i, in an order that depends on the histograms alone.
  // `nearest`, valid during the call, holds the k references of smallest distance to i, i itself among them
  // if it is one, in no order. Ties at the k-th distance go to the higher index. 1 <= k <= size().
  using Visit = std::function<void(std::size_t i, std::span<const Chi2Neighbour> nearest)>;
  void for_each(std::size_t k, const Visit& visit) const;

 private:
  std::vector<std::size_t> bins_;
  float beyond_all_;
  std::vector<std::int32_t> queries_;
  std::vector<float> rows_;  // histograms x bins, in the order of the queries
  Chi2Table table_;
  const chi2_kernel::Kernel& kernel_;
};

}  // namespace salbench
