// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/chi2_table.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "stages/core/check.h"
#include "stages/models/chi2_kernel.h"

namespace salbench {
namespace {

using chi2_kernel::groups_of;
using chi2_kernel::kLanes;

// The boxes of `count` things, of which box(i, bin) gives least and greatest value. Filling has the distance
// NaN and so is never within a limit.
template <class Box>
std::vector<float> boxes_of(std::size_t count, std::size_t bins, Box&& box) {
  std::vector<float> boxes(groups_of(count) * bins * 2 * kLanes, std::numeric_limits<float>::infinity());
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t bin = 0; bin < bins; ++bin) {
      const auto [least, greatest] = box(i, bin);
      float* const place = &boxes[((i / kLanes * bins + bin) * 2) * kLanes + i % kLanes];
      place[0] = least;
      place[kLanes] = greatest;
    }
  return boxes;
}

}  // namespace

Chi2Table::Chi2Table(const Descriptors& descriptors, std::span<const std::size_t> of_bins,
                     std::vector<std::int32_t> in_order)
    : bins(of_bins.size()), order(std::move(in_order)) {
  const std::size_t n = order.size();
  CHECK_LE(1U, n);
  values.resize(groups_of(n) * bins * kLanes);
  for (std::size_t place = 0; place < n; ++place) {
    const auto row = descriptors.row(static_cast<std::size_t>(order[place]));
    for (std::size_t bin = 0; bin < bins; ++bin)
      values[(place / kLanes * bins + bin) * kLanes + place % kLanes] = row[of_bins[bin]];
  }

  std::size_t count = groups_of(n);
  boxes.push_back(boxes_of(count, bins, [&](std::size_t group, std::size_t bin) {
    const float* const first = &values[(group * bins + bin) * kLanes];
    const auto [least, greatest] = std::minmax_element(first, first + std::min(kLanes, n - group * kLanes));
    return std::pair(*least, *greatest);
  }));
  while (count > kLanes) {
    const std::size_t below = count;
    count = groups_of(count);
    const std::vector<float>& lower = boxes.back();
    boxes.push_back(boxes_of(count, bins, [&](std::size_t group, std::size_t bin) {
      const float* const least = &lower[((group * bins + bin) * 2) * kLanes];
      const float* const greatest = least + kLanes;
      const std::size_t members = std::min(kLanes, below - group * kLanes);
      return std::pair(*std::min_element(least, least + members),
                       *std::max_element(greatest, greatest + members));
    }));
  }
}

}  // namespace salbench
