// SPDX-License-Identifier: GPL-3.0-or-later
// The search opens the boxes within a guess of the k-th distance. If k histograms lie within the guess, none
// was missed; otherwise the guess is raised.
#include "stages/models/chi2_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <numeric>
#include <string>

#include "stages/core/check.h"
#include "stages/core/errors.h"
#include "stages/core/parallel.h"
#include "stages/models/chi_square.h"

namespace salbench {
namespace {

using chi2_kernel::groups_of;
using chi2_kernel::kLanes;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
// A bound is computed like a distance, from fewer than 40 rounded terms: it may exceed the distance by
// rounding.
constexpr float kRounding = 1 + 1e-5F;
constexpr float kOpened = std::numeric_limits<float>::quiet_NaN();  // bound of a measured group: in no limit

// Factors on the previous query's k-th distance, and on the expected one: a guess that is slightly too large
// costs less than a second search.
constexpr float kMarginGuessed = 1.02F, kMarginExpected = 1.01F;
constexpr float kAlike = 1e-9F;    // relative to the largest distance: smaller differences are ignored
constexpr std::size_t kSpare = 8;  // so few candidates beyond the k-th are sorted, not counted again

void keep_nearest(std::vector<Chi2Neighbour>& neighbours, std::size_t count) {
  const auto end = neighbours.begin() + static_cast<std::ptrdiff_t>(count);
  std::nth_element(neighbours.begin(), end, neighbours.end(),
                   [](const Chi2Neighbour& a, const Chi2Neighbour& b) {
                     return a.chi2 != b.chi2 ? a.chi2 < b.chi2 : a.index > b.index;
                   });
  neighbours.erase(end, neighbours.end());
}

constexpr float kMaxValue = 1e18F;  // the squares of larger values overflow

// At least one bin.
std::vector<std::size_t> bins_of(const Descriptors& descriptors) {
  for (std::size_t i = 0; i < descriptors.values.size(); ++i)
    if (const float value = descriptors.values[i]; !(value >= 0 && value <= kMaxValue))
      throw ShapeError("the descriptor of point " + std::to_string(i / kFpfhBins) +
                       " (0-based) has the value " + std::to_string(value) +
                       ", expected a number from 0 to 1e18");
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
  std::ranges::copy_if(all, std::back_inserter(order),
                       [&](std::int32_t i) { return taken[static_cast<std::size_t>(i)]; });
  return order;
}

constexpr std::size_t kGrain = 1024;  // consecutive queries of a finder; the first of them has no guess

using Position = std::array<float, 3>;

Position position(const Vec3& point) {
  return {static_cast<float>(point.x()), static_cast<float>(point.y()), static_cast<float>(point.z())};
}

// Smallest grid on which a sum over the whole table is exact: no weight exceeds 2.
float grid_for(const Chi2Search& search) {
  const double largest_sum =
      2 * static_cast<double>(search.beyond_all()) * static_cast<double>(search.size());
  return largest_sum > 0 ? static_cast<float>(std::exp2(std::ceil(std::log2(largest_sum)) - 30)) : 1;
}

// Terms of a sum: one per reference, with its distance weighted by the distance in space.
class Terms {
 public:
  Terms(const Chi2Search& search, Points points, chi2_kernel::Weight weight)
      : points_(points),
        kernel_(search.kernel()),
        weight_(weight),
        grid_(grid_for(search)),
        places_(groups_of(search.size()) * 3 * kLanes) {
    const std::vector<std::int32_t>& order = search.table().order;
    for (std::size_t place = 0; place < order.size(); ++place) {
      const Position at = position(points[static_cast<std::size_t>(order[place])]);
      for (std::size_t axis = 0; axis < 3; ++axis)
        places_[(place / kLanes * 3 + axis) * kLanes + place % kLanes] = at[axis];
    }
  }

  // Sum over the nearest of the i-th histogram.
  double sum(std::size_t i, const Chi2Nearest& nearest) const {
    const Position from = position(points_[i]);
    double sum = kernel_.weighted_sum(weight_, grid_, nearest.sure, nearest.distances, places_.data(),
                                      from.data(), nearest.groups.data(), nearest.groups.size());
    for (const auto& [index, chi2] : nearest.others) {
      const Position at = position(points_[static_cast<std::size_t>(index)]);
      const float dx = at[0] - from[0], dy = at[1] - from[1], dz = at[2] - from[2];
      const float distance = std::sqrt(dx * dx + dy * dy + dz * dz);
      sum += static_cast<double>(chi2_kernel::term_of(weight_, grid_, chi2, distance));
    }
    return sum;
  }

 private:
  Points points_;
  const chi2_kernel::Kernel& kernel_;
  chi2_kernel::Weight weight_;
  float grid_;
  std::vector<float> places_;  // groups x 3 x 16
};

}  // namespace

Chi2Distances::Level::Level(std::size_t all_groups) : groups(all_groups), distances(all_groups * kLanes) {}

Chi2Distances::Chi2Distances(const Chi2Table& table, const chi2_kernel::Kernel& kernel)
    : table_(table),
      kernel_(kernel),
      packed_{table.values.data(), table.alone.data(), table.filled.data(), table.starts.data()},
      places_(groups_of(table.size()) * kLanes) {
  std::size_t groups = groups_of(table.size());
  for (std::size_t level = 0; level <= table.boxes.size(); ++level) {
    levels_.emplace_back(groups);
    groups = groups_of(groups);
  }
}

void Chi2Distances::start(const float* query) {
  query_.values = query;
  query_.filled = 0;
  for (std::size_t bin = 0; bin < table_.bins; ++bin) {
    query_.filled |= std::uint64_t{query[bin] > 0} << bin;
    query_.alone[bin] = chi2_kernel::term_alone(query[bin]);
  }
  for (Level& level : levels_) level.count = 0;
  Level& top = levels_.back();
  top.count = top.groups.size();
  std::iota(top.groups.begin(), top.groups.end(), 0);
  kernel_.bounds(table_.boxes.back().data(), table_.bins, query, top.groups.data(), top.count,
                 top.distances.data());
}

std::size_t Chi2Distances::measure_up_to(float limit, std::size_t max_groups) {
  for (std::size_t level = levels_.size() - 1; level > 0; --level) {
    Level& below = levels_[level - 1];
    const std::size_t more =
        open(levels_[level], limit * kRounding, level > 1 ? groups_of_table() : max_groups, below);
    const std::int32_t* const groups = below.groups.data() + below.count;
    float* const distances = below.distances.data() + below.count * kLanes;
    below.count += more;
    if (level > 1)
      kernel_.bounds(table_.boxes[level - 2].data(), table_.bins, query_.values, groups, more, distances);
    else
      measure(groups, more, distances);
  }
  return count_up_to(limit);
}

// Opens the unopened members within the limit, or the first `max_groups` of them: adds their groups to the
// level below.
std::size_t Chi2Distances::open(Level& level, float limit, std::size_t max_groups, Level& below) {
  const std::size_t within = std::min(
      kernel_.places_between(-1, limit, level.distances.data(), level.count * kLanes, places_.data()),
      max_groups);
  for (std::size_t i = 0; i < within; ++i) {
    const auto at = static_cast<std::size_t>(places_[i]);
    below.groups[below.count + i] = level.groups[at / kLanes] * static_cast<std::int32_t>(kLanes) +
                                    static_cast<std::int32_t>(at % kLanes);
    level.distances[at] = kOpened;
  }
  return within;
}

void Chi2Distances::measure(const std::int32_t* groups, std::size_t count, float* distances) const {
  kernel_.distances(packed_, query_, groups, count, distances);
  const std::size_t members = (table_.size() - 1) % kLanes + 1;  // members of the last group, which is padded
  const auto last = static_cast<std::int32_t>(groups_of(table_.size()) - 1);
  for (std::size_t g = 0; g < count; ++g)
    if (groups[g] == last)
      std::fill(distances + g * kLanes + members, distances + (g + 1) * kLanes, kInfinity);
}

std::size_t Chi2Distances::count_up_to(float limit) const {
  const Level& leaves = levels_.front();
  return kernel_.count_up_to(limit, leaves.distances.data(), leaves.count * kLanes);
}

void Chi2Distances::append_between(float low, float high, std::vector<Chi2Neighbour>& neighbours) {
  const Level& leaves = levels_.front();
  const std::size_t count =
      kernel_.places_between(low, high, leaves.distances.data(), leaves.count * kLanes, places_.data());
  for (std::size_t i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(places_[i]);
    const std::size_t place = static_cast<std::size_t>(leaves.groups[at / kLanes]) * kLanes + at % kLanes;
    neighbours.push_back({table_.order[place], leaves.distances[at]});
  }
}

Chi2Finder::Chi2Finder(const Chi2Search& search, std::size_t k)
    : distances_(search.table(), search.kernel()),
      k_(k),
      beyond_all_(search.beyond_all()),
      last_kth_(beyond_all_),
      last_kth_above_zero_(beyond_all_) {
  CHECK_LE(1U, k);
  CHECK_LE(k, search.size());
}

Chi2Nearest Chi2Finder::find(const float* query, float expected) {
  distances_.start(query);
  return find_started(expected);
}

std::optional<Chi2Nearest> Chi2Finder::find_unless_alike(const float* query, float expected) {
  distances_.start(query);
  if (last_alike_ && are_alike()) return std::nullopt;
  const Chi2Nearest nearest = find_started(expected);
  const float alike = kAlike * beyond_all_;
  // If there are others, fewer than k lie within `sure`: counting is needed only below it.
  last_alike_ = (nearest.others.empty() || nearest.sure < alike) && distances_.count_up_to(alike) >= k_;
  if (last_alike_) return std::nullopt;
  return nearest;
}

bool Chi2Finder::are_alike() {
  const float alike = kAlike * beyond_all_;
  const std::size_t some = 2 * groups_of(k_);
  return distances_.measure_up_to(alike, some) >= k_ ||
         (distances_.groups().size() == some && distances_.measure_up_to(alike) >= k_);
}

Chi2Nearest Chi2Finder::find_started(float expected) {
  const float limit = expected > 0 ? kMarginExpected * expected : kMarginGuessed * last_kth_;
  Limit most{limit, distances_.measure_up_to(limit)};
  while (most.count < k_) {
    most.value = raised(most);
    most.count = distances_.measure_up_to(most.value);
  }
  const Limit least = narrow(most);
  others_.clear();
  distances_.append_between(least.value, most.value, others_);
  keep_nearest(others_, k_ - least.count);
  last_kth_ = most.value;
  if (last_kth_ > 0) last_kth_above_zero_ = last_kth_;
  return {most.value, least.value, others_, distances_.groups(), distances_.values()};
}

// Assumes that the number of points within a distance grows with its third power.
float Chi2Finder::raised(const Limit& limit) const {
  if (limit.value == 0) return last_kth_above_zero_;
  const float missing = static_cast<float>(k_) / static_cast<float>(std::max<std::size_t>(limit.count, 1));
  return std::min(limit.value * std::min(1.02F + 0.5F * (missing - 1), 2.0F), beyond_all_);
}

// Lowers `most`, which covers at least k, until it covers k, or a few more than the returned limit, which
// covers at most k, all among the k nearest.
Chi2Finder::Limit Chi2Finder::narrow(Limit& most) const {
  Limit least{-1, 0};
  for (int probe = 0; probe < 24 && most.count > k_ && most.count - least.count > kSpare; ++probe) {
    const float share =
        (static_cast<float>(k_ - least.count) + 0.5F) / static_cast<float>(most.count - least.count);
    const float low = std::max(least.value, 0.0F);
    const float middle = low + (most.value - low) * (probe % 4 == 3 ? 0.5F : share);
    if (!(middle > least.value && middle < most.value)) break;
    const Limit at{middle, distances_.count_up_to(middle)};
    (at.count >= k_ ? most : least) = at;
  }
  return most.count == k_ ? most : least;
}

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

std::vector<double> weighted_sums(const Chi2Search& search, std::size_t k, Points points,
                                  chi2_kernel::Weight weight, std::vector<float>& kth) {
  const std::size_t n = search.queries().size();
  CHECK_EQ(points.size(), n);
  kth.resize(n);
  const Terms terms(search, points, weight);
  std::vector<double> sums(n);
  parallel_ranges(n, kGrain, [&](std::size_t first, std::size_t last) {
    Chi2Finder finder(search, k);
    for (std::size_t q = first; q < last; ++q) {
      const auto i = static_cast<std::size_t>(search.queries()[q]);
      const std::optional<Chi2Nearest> nearest = finder.find_unless_alike(search.row(q), kth[i]);
      if (!nearest) continue;
      kth[i] = nearest->kth;
      sums[i] = terms.sum(i, *nearest);
    }
  });
  return sums;
}

}  // namespace salbench
