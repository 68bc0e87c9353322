// SPDX-License-Identifier: GPL-3.0-or-later
// Random numbers that several metrics read from their beginning. Each is drawn once, when the first metric
// asks: what a metric reads does not depend on the others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "stages/core/rng.h"

namespace salbench {

class UniformDraws {
 public:
  explicit UniformDraws(const Rng& rng) : rng_(rng) {}
  std::span<const double> first(std::size_t count);  // in [0, 1); valid until the next call

 private:
  Rng rng_;
  std::vector<double> drawn_;
};

// Values of a map at points drawn uniformly, with replacement, from all but the first. [tasse2016]
class ValueDraws {
 public:
  ValueDraws(std::span<const double> map, const Rng& rng) : map_(map), rng_(rng) {}  // at least two points
  std::span<const double> first(std::size_t count);  // valid until the next call

 private:
  std::span<const double> map_;
  Rng rng_;
  std::vector<double> drawn_;
};

}  // namespace salbench
