// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/picks.h"

#include <algorithm>

namespace salbench {

std::vector<PickGroup> pick_groups(std::span<const double> map, std::span<const std::int32_t> picked) {
  std::vector<PickGroup> points;
  points.reserve(picked.size());
  for (std::size_t k = 0; k < picked.size(); ++k) {
    if (k > 0 && picked[k] == picked[k - 1])
      ++points.back().picks;
    else
      points.push_back({map[static_cast<std::size_t>(picked[k])], 1, 1});
  }
  std::ranges::sort(points, {}, &PickGroup::value);
  std::vector<PickGroup> groups;
  groups.reserve(points.size());
  for (const PickGroup& point : points) {
    if (groups.empty() || groups.back().value != point.value) {
      groups.push_back(point);
      continue;
    }
    groups.back().picks += point.picks;
    groups.back().distinct += point.distinct;
  }
  for (const double value : map) {
    const auto group = std::ranges::lower_bound(groups, value, {}, &PickGroup::value);
    if (group != groups.end()) ++(group->value == value ? group->equal : group->below);
  }
  double below = 0;
  for (PickGroup& group : groups) {
    group.below += below;
    below = group.below + group.equal;
  }
  return groups;
}

}  // namespace salbench
