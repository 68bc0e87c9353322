// SPDX-License-Identifier: GPL-3.0-or-later
// Picked points by their values: what ROC curves climb.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace salbench {

// The picks of one value.
struct PickGroup {
  double value;
  double picks;                 // with multiplicity
  double distinct;              // points
  double below = 0, equal = 0;  // points of the map with a smaller value, and with this one
};

// By ascending value. `picked` ascends.
std::vector<PickGroup> pick_groups(std::span<const double> map, std::span<const std::int32_t> picked);

}  // namespace salbench
