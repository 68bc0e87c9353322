// SPDX-License-Identifier: GPL-3.0-or-later
// Halves the histograms, on the border of a group, at the median of the bin that varies most. Square roots
// make variations of high and low bins count alike.
#include "stages/models/chi2_grouping.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "stages/core/parallel.h"
#include "stages/models/chi2_kernel.h"

namespace salbench {
namespace {

using chi2_kernel::groups_of;
using chi2_kernel::kLanes;

constexpr std::size_t kBins = kFpfhBins;

class Grouping {
 public:
  Grouping(const Descriptors& descriptors, std::span<const std::size_t> bins) : bins_(bins) {
    roots_.reserve(descriptors.size() * bins.size());
    for (std::size_t i = 0; i < descriptors.size(); ++i)
      for (const std::size_t bin : bins) roots_.push_back(std::sqrt(descriptors.values[i * kBins + bin]));
    order_.resize(descriptors.size());
    std::iota(order_.begin(), order_.end(), 0);
  }

  std::vector<std::int32_t> order() && {
    // Level by level, the ranges of a level at the same time.
    for (std::vector<Range> ranges{{0, order_.size()}}; !ranges.empty();) {
      std::vector<std::array<Range, 2>> halves(ranges.size());
      parallel_ranges(ranges.size(), 1, [&](std::size_t r, std::size_t) { halves[r] = halved(ranges[r]); });
      ranges.clear();
      for (const auto& both : halves)
        std::copy_if(both.begin(), both.end(), std::back_inserter(ranges),
                     [](const Range& r) { return r.first < r.last; });
    }
    return std::move(order_);
  }

 private:
  static constexpr std::size_t kSmall = 1 << 14;  // halved down to groups at once

  struct Range {
    std::size_t first = 0, last = 0;
  };

  // The halves that are not in order yet; others are empty.
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
    std::array<double, kBins> sums{}, squares{};
    for (std::size_t place = first; place < last; ++place)
      for (std::size_t bin = 0; bin < bins_.size(); ++bin) {
        const double value = static_cast<double>(root(order_[place], bin));
        sums[bin] += value;
        squares[bin] += value * value;
      }
    const auto n = static_cast<double>(last - first);
    for (std::size_t bin = 0; bin < bins_.size(); ++bin) squares[bin] -= sums[bin] * sums[bin] / n;
    return static_cast<std::size_t>(std::max_element(squares.begin(), squares.end()) - squares.begin());
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

std::vector<std::int32_t> grouped_by_likeness(const Descriptors& descriptors,
                                              std::span<const std::size_t> bins) {
  return Grouping(descriptors, bins).order();
}

}  // namespace salbench
