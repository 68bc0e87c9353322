// SPDX-License-Identifier: GPL-3.0-or-later
// Properties of a shape that metrics need besides the map and the ground truth.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

inline constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();  // for metrics

struct SurfaceGraph;

// Empty fields are unknown.
struct Measures {
  std::size_t size = 0;          // n points
  ScalarField areas = {};        // n weights >= 0
  ScalarField centre_bias = {};  // n values >= 0, relative to each other: not normalised
  ScalarField negatives = {};    // n weights >= 0 of the points as negatives of sauc
  std::shared_ptr<const SurfaceGraph> surface = {};

  Measures at(std::span<const std::int32_t> points) const;  // restricted to these points
};

}  // namespace salbench
