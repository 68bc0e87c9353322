// SPDX-License-Identifier: GPL-3.0-or-later
// Bins of values and distances: some between each two knots.
#pragma once

#include <algorithm>
#include <cstddef>

#include "stages/fitting/fitting.h"

namespace salbench::fitting {

// A place between two knots.
struct Between {
  std::size_t knot = 0;  // the lower one
  double of_upper = 0;   // weight of the upper one
};

template <std::size_t knots, std::size_t per_interval>
struct Bins {
  static constexpr std::size_t count = (knots - 1) * per_interval;

  static std::size_t of(double x) {  // in [0, 1]
    return std::min(static_cast<std::size_t>(x * static_cast<double>(count)), count - 1);
  }
  static Between middle(std::size_t bin) {
    return {bin / per_interval, (static_cast<double>(bin % per_interval) + 0.5) / per_interval};
  }
  static Between at(double x) {
    const double place = x * static_cast<double>(knots - 1);
    const std::size_t knot = std::min(static_cast<std::size_t>(place), knots - 2);
    return {knot, place - static_cast<double>(knot)};
  }
};
using ValueBins = Bins<kValueKnots, 4>;
using DistanceBins = Bins<kDistanceKnots, 2>;

template <class Knots>
double linear(const Knots& at_knots, const Between& x) {
  return at_knots[x.knot] * (1 - x.of_upper) + at_knots[x.knot + 1] * x.of_upper;
}

}  // namespace salbench::fitting
