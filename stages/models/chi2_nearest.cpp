// SPDX-License-Identifier: GPL-3.0-or-later
// The search opens the boxes within a guess of the k-th distance. If k histograms lie within the guess, none
// was missed; otherwise the guess is raised.
#include "stages/models/chi2_nearest.h"

#include <algorithm>

namespace salbench {
namespace {

using chi2_kernel::kLanes;

// Times the k-th distance that is guessed from another query, or expected: a little too far costs less than a
// second look.
constexpr float kMarginGuessed = 1.02F, kMarginExpected = 1.01F;
constexpr float kAlike = 1e-9F;    // of the largest distance: within, histograms do not differ
constexpr std::size_t kSpare = 8;  // so few candidates beyond the k-th are put in order, not counted again

void keep_nearest(std::vector<Chi2Neighbour>& neighbours, std::size_t count) {
  const auto end = neighbours.begin() + static_cast<std::ptrdiff_t>(count);
  std::nth_element(neighbours.begin(), end, neighbours.end(),
                   [](const Chi2Neighbour& a, const Chi2Neighbour& b) {
                     return a.chi2 != b.chi2 ? a.chi2 < b.chi2 : a.index > b.index;
                   });
  neighbours.erase(end, neighbours.end());
}

}  // namespace

Chi2Nearest::Chi2Nearest(const Chi2Table& table, const chi2_kernel::Kernel& kernel, std::size_t k,
                         float beyond_all)
    : kernel_(kernel),
      look_(table, kernel),
      k_(k),
      bins_(table.bins),
      beyond_all_(beyond_all),
      last_above_zero_(beyond_all),
      recent_(table.bins * kLanes) {}

void Chi2Nearest::start(const float* query) {
  query_ = query;
  look_.start(query);
}

bool Chi2Nearest::find_unless_alike(float expected) {
  alike_ = alike_ && are_alike();
  if (alike_) return false;
  find(expected);
  const float alike = kAlike * beyond_all_;
  alike_ = short_of_kth_ < alike && look_.count_up_to(alike) >= k_;
  return !alike_;
}

bool Chi2Nearest::are_alike() {
  const float alike = kAlike * beyond_all_;
  const std::size_t some = 2 * chi2_kernel::groups_of(k_);
  return look_.up_to(alike, some) >= k_ || (look_.opened() == some && look_.up_to(alike) >= k_);
}

void Chi2Nearest::find(float expected) {
  const float limit = expected > 0 ? kMarginExpected * expected : guess();
  Limit most{limit, look_.up_to(limit)};
  while (most.count < k_) {
    most.value = raised(most);
    most.count = look_.up_to(most.value);
  }
  const Limit least = narrow(most);
  short_of_kth_ = least.count < k_ ? least.value : -1;
  kth_ = most.value;
  sure_ = least.value;
  others_.clear();
  look_.append_between(least.value, most.value, others_);
  keep_nearest(others_, k_ - least.count);
  if (kth_ > 0) last_above_zero_ = kth_;
  remember();
}

// The k-th distance of the most similar of the last queries.
float Chi2Nearest::guess() const {
  if (found_ == 0) return beyond_all_;
  constexpr std::int32_t kGroup = 0;
  std::array<float, kLanes> distances;
  kernel_.distances(recent_.data(), bins_, query_, &kGroup, 1, distances.data());
  const auto end = distances.begin() + static_cast<std::ptrdiff_t>(std::min(found_, kLanes));
  const auto nearest = static_cast<std::size_t>(std::min_element(distances.begin(), end) - distances.begin());
  return std::min(kMarginGuessed * recent_kth_[nearest], beyond_all_);
}

void Chi2Nearest::remember() {
  const std::size_t lane = found_++ % kLanes;
  for (std::size_t bin = 0; bin < bins_; ++bin) recent_[bin * kLanes + lane] = query_[bin];
  recent_kth_[lane] = kth_;
}

// As the number of points within a distance grows with its third power or so.
float Chi2Nearest::raised(const Limit& limit) const {
  if (limit.value == 0) return last_above_zero_;
  const float missing = static_cast<float>(k_) / static_cast<float>(std::max<std::size_t>(limit.count, 1));
  return std::min(limit.value * std::min(1.02F + 0.5F * (missing - 1), 2.0F), beyond_all_);
}

// Lowers `most`, which holds k or more, until it holds k, or a few more than the limit returned, which holds
// k or fewer, all of them among the k nearest.
Chi2Nearest::Limit Chi2Nearest::narrow(Limit& most) const {
  Limit least{-1, 0};
  for (int probe = 0; probe < 24 && most.count > k_ && most.count - least.count > kSpare; ++probe) {
    const float share =
        (static_cast<float>(k_ - least.count) + 0.5F) / static_cast<float>(most.count - least.count);
    const float low = std::max(least.value, 0.0F);
    const float middle = low + (most.value - low) * (probe % 4 == 3 ? 0.5F : share);
    if (!(middle > least.value && middle < most.value)) break;
    const Limit at{middle, look_.count_up_to(middle)};
    (at.count >= k_ ? most : least) = at;
  }
  return most.count == k_ ? most : least;
}

}  // namespace salbench
