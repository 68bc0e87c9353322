// SPDX-License-Identifier: GPL-3.0-or-later
// Picked points by their values: what ROC curves climb.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "stages/metrics/distribution.h"

namespace salbench {

// The picks of one value.
struct PickGroup {
  double value;
  double picks;       // with multiplicity
  double distinct;    // points
  std::size_t below;  // points of the map with a smaller value
};

// By ascending value. `picked` ascends; `of_map` is the map's distribution, by whatever its points are
// weighed.
std::vector<PickGroup> pick_groups(std::span<const double> map, std::span<const std::int32_t> picked,
                                   const Distribution& of_map);

}  // namespace salbench
