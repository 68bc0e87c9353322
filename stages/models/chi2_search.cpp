// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/chi2_search.h"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <string>

#include "stages/core/check.h"
#include "stages/core/errors.h"
#include "stages/models/chi2_grouping.h"
#include "stages/models/chi_square.h"

namespace salbench {
namespace {

constexpr std::size_t kBins = kFpfhBins;
constexpr float kMaxValue = 1e18F;  // the squares of larger values overflow

// At least one.
std::vector<std::size_t> bins_of(const Descriptors& descriptors) {
  for (std::size_t i = 0; i < descriptors.values.size(); ++i)
    if (const float value = descriptors.values[i]; !(value >= 0 && value <= kMaxValue))
      throw ShapeError("the descriptor of point " + std::to_string(i / kBins) + " (0-based) has the value " +
                       std::to_string(value) + ", expected a number from 0 to 1e18");
  std::vector<std::size_t> bins = used_bins(descriptors);
  if (bins.empty()) bins.push_back(0);
  return bins;
}

// No (a - b)^2 / (a + b) is above a + b.
float beyond_all_of(const Descriptors& descriptors) {
  float largest = 0;
  for (std::size_t i = 0; i < descriptors.size(); ++i) {
    const auto row = descriptors.row(i);
    largest = std::max(largest, std::accumulate(row.begin(), row.end(), 0.0F));
  }
  return 2.01F * largest;
}

// The references, ascending, in the order of all histograms.
std::vector<std::int32_t> in_order_of(const std::vector<std::int32_t>& all,
                                      std::span<const std::int32_t> references) {
  if (references.empty()) return all;
  std::vector<bool> taken(all.size(), false);
  for (const std::int32_t i : references) taken[static_cast<std::size_t>(i)] = true;
  std::vector<std::int32_t> order;
  order.reserve(references.size());
  std::copy_if(all.begin(), all.end(), std::back_inserter(order),
               [&](std::int32_t i) { return taken[static_cast<std::size_t>(i)]; });
  return order;
}

}  // namespace

Chi2Search::Chi2Search(const Descriptors& descriptors, std::span<const std::int32_t> references)
    : bins_(bins_of(descriptors)),
      beyond_all_(beyond_all_of(descriptors)),
      queries_(grouped_by_likeness(descriptors, bins_)),
      table_(descriptors, bins_, in_order_of(queries_, references)),
      kernel_(chi2_kernel::kernel()) {
  rows_.reserve(queries_.size() * bins_.size());
  for (const std::int32_t i : queries_)
    for (const std::size_t bin : bins_) rows_.push_back(descriptors.row(static_cast<std::size_t>(i))[bin]);
}

Chi2Nearest Chi2Search::nearest(std::size_t k) const {
  CHECK_LE(1U, k);
  CHECK_LE(k, size());
  return Chi2Nearest(table_, kernel_, k, beyond_all_);
}

void Chi2Search::for_each(std::size_t k, const Visit& visit) const {
  Chi2Nearest search = nearest(k);
  std::vector<Chi2Neighbour> found;
  for (std::size_t q = 0; q < queries_.size(); ++q) {
    search.start(row(q));
    search.find();
    found = search.others();
    search.look().append_between(-1, search.sure(), found);
    visit(static_cast<std::size_t>(queries_[q]), found);
  }
}

}  // namespace salbench
