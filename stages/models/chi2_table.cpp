// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/chi2_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include "stages/core/check.h"
#include "stages/core/parallel.h"
#include "stages/models/chi2_kernel.h"

namespace salbench {
namespace {

using chi2_kernel::groups_of;
using chi2_kernel::kLanes;

// Boxes of `count` things, of which box(i, bin) gives least and greatest value. Padding has the distance NaN
// and so is never within a limit.
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

// Halves the histograms, at the border of a group, at the median of the bin that varies most. Square roots
// make variations of large and small values comparable.
class Grouping {
 public:
  Grouping(const Descriptors& descriptors, std::span<const std::size_t> bins) : bins_(bins) {
    roots_.reserve(descriptors.size() * bins.size());
    for (std::size_t i = 0; i < descriptors.size(); ++i)
      for (const std::size_t bin : bins) roots_.push_back(std::sqrt(descriptors.values[i * kFpfhBins + bin]));
    order_.resize(descriptors.size());
    std::iota(order_.begin(), order_.end(), 0);
  }

  std::vector<std::int32_t> order() && {
    // Level by level, the ranges of a level in parallel.
    for (std::vector<Range> ranges{{0, order_.size()}}; !ranges.empty();) {
      std::vector<std::array<Range, 2>> halves(ranges.size());
      parallel_ranges(ranges.size(), 1, [&](std::size_t r, std::size_t) { halves[r] = halved(ranges[r]); });
      ranges.clear();
      for (const auto& both : halves)
        std::ranges::copy_if(both, std::back_inserter(ranges),
                             [](const Range& r) { return r.first < r.last; });
    }
    return std::move(order_);
  }

 private:
  static constexpr std::size_t kSmall = 1 << 14;  // halved to single groups in one task

  struct Range {
    std::size_t first = 0, last = 0;
  };

  // Halves that are not yet ordered; others are empty.
  std::array<Range, 2> halved(const Range& range) {
    const auto [first, last] = range;
    if (last - first <= kSmall) {
      split(first, last);
      return {};
    }
    const std::size_t middle = halve(first, last);
    return {Range{first, middle}, Range{middle, last}};
  }

  float root(std::int32_t i, std::size_t bin) const {
    return roots_[static_cast<std::size_t>(i) * bins_.size() + bin];
  }

  std::size_t most_varying(std::size_t first, std::size_t last) const {
    std::array<double, kFpfhBins> sums{}, squares{};
    for (std::size_t place = first; place < last; ++place)
      for (std::size_t bin = 0; bin < bins_.size(); ++bin) {
        const auto value = static_cast<double>(root(order_[place], bin));
        sums[bin] += value;
        squares[bin] += value * value;
      }
    const auto n = static_cast<double>(last - first);
    for (std::size_t bin = 0; bin < bins_.size(); ++bin) squares[bin] -= sums[bin] * sums[bin] / n;
    return static_cast<std::size_t>(std::ranges::max_element(squares) - squares.begin());
  }

  // Returns the middle.
  std::size_t halve(std::size_t first, std::size_t last) {
    const std::size_t bin = most_varying(first, last);
    const std::size_t middle = first + (groups_of(last - first) + 1) / 2 * kLanes;
    const auto at = [&](std::size_t place) { return order_.begin() + static_cast<std::ptrdiff_t>(place); };
    std::nth_element(at(first), at(middle), at(last), [&](std::int32_t a, std::int32_t b) {
      return std::pair(root(a, bin), a) < std::pair(root(b, bin), b);
    });
    return middle;
  }

  void split(std::size_t first, std::size_t last) {
    if (last - first <= kLanes) return;
    const std::size_t middle = halve(first, last);
    split(first, middle);
    split(middle, last);
  }

  std::span<const std::size_t> bins_;
  std::vector<float> roots_;  // n x used bins
  std::vector<std::int32_t> order_;
};

}  // namespace

Chi2Table::Chi2Table(const Descriptors& descriptors, std::span<const std::size_t> of_bins,
                     std::vector<std::int32_t> in_order)
    : bins(of_bins.size()), order(std::move(in_order)) {
  const std::size_t n = order.size();
  CHECK_LE(1U, n);
  CHECK_LE(bins, chi2_kernel::kMaxBins);
  std::vector<float> all(groups_of(n) * bins * kLanes);  // groups x bins x 16
  for (std::size_t place = 0; place < n; ++place) {
    const auto row = descriptors.row(static_cast<std::size_t>(order[place]));
    for (std::size_t bin = 0; bin < bins; ++bin)
      all[(place / kLanes * bins + bin) * kLanes + place % kLanes] = row[of_bins[bin]];
  }
  pack(all);

  std::size_t count = groups_of(n);
  boxes.push_back(boxes_of(count, bins, [&](std::size_t group, std::size_t bin) {
    const float* const first = &all[(group * bins + bin) * kLanes];
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

void Chi2Table::pack(const std::vector<float>& all) {
  const auto group_of = [&](std::size_t group, std::size_t bin) {
    return std::span(all).subspan((group * bins + bin) * kLanes, kLanes);
  };
  const std::size_t groups = all.size() / (bins * kLanes);
  for (std::size_t first = 0; first < groups; first += chi2_kernel::kUnit) {
    const std::size_t last = std::min(first + chi2_kernel::kUnit, groups);
    std::uint64_t in_unit = 0;
    for (std::size_t group = first; group < last; ++group)
      for (std::size_t bin = 0; bin < bins; ++bin)
        if (std::ranges::max(group_of(group, bin)) > 0) in_unit |= std::uint64_t{1} << bin;
    filled.push_back(in_unit);
    starts.push_back(values.size());
    for (std::size_t group = first; group < last; ++group)
      for (std::size_t bin = 0; bin < bins; ++bin)
        if ((in_unit >> bin & 1) != 0) std::ranges::copy(group_of(group, bin), std::back_inserter(values));
  }
  alone.resize(values.size());
  std::ranges::transform(values, alone.begin(), chi2_kernel::term_alone);
}

std::vector<std::int32_t> grouped_by_likeness(const Descriptors& descriptors,
                                              std::span<const std::size_t> bins) {
  return Grouping(descriptors, bins).order();
}

}  // namespace salbench
