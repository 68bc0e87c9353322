// SPDX-License-Identifier: GPL-3.0-or-later
// Histograms for a search in chi-square distance: similar ones form groups of 16, groups form groups of 16
// and so on, each with its bounding box.
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
  // As in chi2_kernel::PackedTable, with the last group padded by empty histograms.
  std::vector<float> values, alone;
  std::vector<std::uint64_t> filled;
  std::vector<std::size_t> starts;
  // Groups x bins x 2 x 16: boxes around the groups of histograms, around groups of such boxes, and so on
  // until one group is left. Last groups are padded with boxes at infinity.
  std::vector<std::vector<float>> boxes;

  // `in_order`: indices of at least one histogram, similar ones adjacent.
  Chi2Table(const Descriptors& descriptors, std::span<const std::size_t> of_bins,
            std::vector<std::int32_t> in_order);

  std::size_t size() const { return order.size(); }

 private:
  void pack(const std::vector<float>& all);
};

// n indices: the histograms in an order in which the members of each group of 16 are similar, and so are
// adjacent groups. Considers only these bins. Independent of the number of threads.
std::vector<std::int32_t> grouped_by_likeness(const Descriptors& descriptors,
                                              std::span<const std::size_t> bins);

}  // namespace salbench
