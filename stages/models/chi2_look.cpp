// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/chi2_look.h"

#include <algorithm>
#include <numeric>

namespace salbench {
namespace {

using chi2_kernel::groups_of;
using chi2_kernel::kLanes;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
// A bound is computed like a distance, from fewer than 40 rounded terms: it may exceed the distance by
// rounding.
constexpr float kRounding = 1 + 1e-5F;
constexpr float kOpened = std::numeric_limits<float>::quiet_NaN();  // in place of a bound: within no limit

}  // namespace

Chi2Look::Level::Level(std::size_t all_groups) : groups(all_groups), distances(all_groups * kLanes) {}

Chi2Look::Chi2Look(const Chi2Table& table, const chi2_kernel::Kernel& kernel)
    : table_(table), kernel_(kernel), places_(groups_of(table.size()) * kLanes) {
  std::size_t groups = groups_of(table.size());
  for (std::size_t level = 0; level <= table.boxes.size(); ++level) {
    levels_.emplace_back(groups);
    groups = groups_of(groups);
  }
}

void Chi2Look::start(const float* query) {
  query_ = query;
  for (Level& level : levels_) level.count = 0;
  Level& top = levels_.back();
  top.count = top.groups.size();
  std::iota(top.groups.begin(), top.groups.end(), 0);
  kernel_.bounds(table_.boxes.back().data(), table_.bins, query_, top.groups.data(), top.count,
                 top.distances.data());
}

std::size_t Chi2Look::up_to(float limit, std::size_t most_groups) {
  for (std::size_t level = levels_.size() - 1; level > 0; --level) {
    Level& below = levels_[level - 1];
    const std::size_t more =
        open(levels_[level], limit * kRounding, level > 1 ? groups() : most_groups, below);
    const std::int32_t* const groups = below.groups.data() + below.count;
    float* const distances = below.distances.data() + below.count * kLanes;
    below.count += more;
    if (level > 1)
      kernel_.bounds(table_.boxes[level - 2].data(), table_.bins, query_, groups, more, distances);
    else
      measure(groups, more, distances);
  }
  return count_up_to(limit);
}

// Opens the members within the limit that have not been opened, or the first so many of them: adds their
// groups to the level below.
std::size_t Chi2Look::open(Level& level, float limit, std::size_t most, Level& below) {
  const std::size_t within = std::min(
      kernel_.places_between(-1, limit, level.distances.data(), level.count * kLanes, places_.data()), most);
  for (std::size_t i = 0; i < within; ++i) {
    const auto at = static_cast<std::size_t>(places_[i]);
    below.groups[below.count + i] = level.groups[at / kLanes] * static_cast<std::int32_t>(kLanes) +
                                    static_cast<std::int32_t>(at % kLanes);
    level.distances[at] = kOpened;
  }
  return within;
}

void Chi2Look::measure(const std::int32_t* groups, std::size_t count, float* distances) const {
  kernel_.distances(table_.values.data(), table_.bins, query_, groups, count, distances);
  const std::size_t members = (table_.size() - 1) % kLanes + 1;  // of the last group, which is filled up
  const auto last = static_cast<std::int32_t>(groups_of(table_.size()) - 1);
  for (std::size_t g = 0; g < count; ++g)
    if (groups[g] == last)
      std::fill(distances + g * kLanes + members, distances + (g + 1) * kLanes, kInfinity);
}

std::size_t Chi2Look::count_up_to(float limit) const {
  const Level& leaves = levels_.front();
  return kernel_.count_up_to(limit, leaves.distances.data(), leaves.count * kLanes);
}

void Chi2Look::append_between(float low, float high, std::vector<Chi2Neighbour>& found) {
  const Level& leaves = levels_.front();
  const std::size_t count =
      kernel_.places_between(low, high, leaves.distances.data(), leaves.count * kLanes, places_.data());
  for (std::size_t i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(places_[i]);
    const std::size_t place = static_cast<std::size_t>(leaves.groups[at / kLanes]) * kLanes + at % kLanes;
    found.push_back({table_.order[place], leaves.distances[at]});
  }
}

double Chi2Look::sum_up_to(float limit, chi2_kernel::Weight weight, float grid, const float* places,
                           const float* from) const {
  const Level& leaves = levels_.front();
  return kernel_.weighted_sum(weight, grid, limit, leaves.distances.data(), places, from,
                              leaves.groups.data(), leaves.count);
}

}  // namespace salbench
