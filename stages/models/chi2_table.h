// SPDX-License-Identifier: GPL-3.0-or-later
// Histograms to be searched in chi-square distance: those that resemble each other lie in groups of 16,
// groups in groups of 16 and so on, each with the box that holds it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

struct Chi2Table {
  std::size_t bins = 0;             // number of used bins
  std::vector<std::int32_t> order;  // place -> index of the histogram
  // As in chi2_kernel::PackedTable, the last group filled up with empty histograms.
  std::vector<float> values, alone;
  std::vector<std::uint64_t> filled;
  std::vector<std::size_t> starts;
  // Groups x bins x 2 x 16: boxes around the groups of histograms, around groups of such boxes, and so on
  // until one group is left. Last groups are filled up with boxes at infinity.
  std::vector<std::vector<float>> boxes;

  // `in_order`: indices of at least one histogram, beside each other those that resemble each other.
  Chi2Table(const Descriptors& descriptors, std::span<const std::size_t> of_bins,
            std::vector<std::int32_t> in_order);

  std::size_t size() const { return order.size(); }

 private:
  void pack(const std::vector<float>& all);
};

// n indices: the histograms in an order in which each group of 16 in a row resemble each other, as do groups
// beside each other. Looks only at these bins. Does not depend on the number of threads.
std::vector<std::int32_t> grouped_by_likeness(const Descriptors& descriptors,
                                              std::span<const std::size_t> bins);

}  // namespace salbench
