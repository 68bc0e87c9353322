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

namespace salbench {

struct Chi2Neighbour {
  std::int32_t index;
  float chi2;
};

class Chi2Search {
 public:
  // Leaves out bins that are 0 in every histogram. Throws InputError if a value is negative, not finite, or
  // so large that its square overflows. Each histogram is compared with those of `references`, ascending
  // indices, or if there are none with all.
  explicit Chi2Search(const Descriptors& descriptors, std::span<const std::int32_t> references = {},
                      chi2_kernel::Instructions instructions = chi2_kernel::widest_supported());

  std::size_t size() const { return order_.size(); }  // histograms that each is compared with
  std::size_t used_bins() const { return bins_.size(); }

  // Calls visit(i, nearest) once for each histogram i, in an order that depends on the histograms alone.
  // `nearest`, valid during the call, holds the k references of smallest distance to i, i itself among them
  // if it is one, in no order. Ties at the k-th distance go to the higher index. 1 <= k <= size().
  using Visit = std::function<void(std::size_t i, std::span<const Chi2Neighbour> nearest)>;
  void for_each(std::size_t k, const Visit& visit) const;

  // Sums chi2 * weight(d) over the k nearest references of each histogram; d is the distance between their
  // points. `points` has one per histogram, no two farther apart than 2, and is read in single precision.
  std::vector<double> weighted_sums(std::size_t k, std::span<const Vec3> points,
                                    chi2_kernel::Weight weight) const;

 private:
  friend class Chi2Query;

  std::vector<std::size_t> bins_;
  float beyond_all_ = 0;               // distance
  std::vector<float> rows_;            // histograms x bins, in the order of the queries
  std::vector<std::int32_t> queries_;  // all histograms; those beside each other resemble each other
  std::vector<std::int32_t> order_;    // place in the table -> index of the histogram
  std::vector<float> table_;           // groups x bins x 16, the last group filled up with empty histograms
  // Boxes around the groups of 16 histograms, around 16 such boxes, and so on until one group is left.
  std::vector<std::vector<float>> boxes_;
  chi2_kernel::Kernel kernel_;
};

}  // namespace salbench
