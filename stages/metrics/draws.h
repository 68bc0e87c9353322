// SPDX-License-Identifier: GPL-3.0-or-later
// Random numbers that several metrics read from their beginning, of one map or of all that are scored with
// the same stream. Each is drawn once, when the first one asks: what a metric reads does not depend on the
// others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "stages/core/rng.h"

namespace salbench {

// Not for several threads. What it returns is valid until the next call.
class Draws {
 public:
  explicit Draws(const Rng& rng) : rng_(rng), uniform_rng_(rng), below_rng_(rng) {}

  const Rng& rng() const { return rng_; }                                        // at the beginning
  std::span<const double> uniform(std::size_t count);                            // in [0, 1)
  std::span<const std::uint32_t> below(std::uint32_t bound, std::size_t count);  // 0..bound-1; bound > 0

 private:
  Rng rng_, uniform_rng_, below_rng_;
  std::vector<double> uniform_;
  std::uint32_t bound_ = 0;  // of below_
  std::vector<std::uint32_t> below_;
};

// Values of a map at points drawn uniformly, with replacement, from all but the first. [tasse2016]
class ValueDraws {
 public:
  // At least two points, before the first draw. Both outlive it.
  ValueDraws(std::span<const double> map, Draws& draws) : map_(map), draws_(draws) {}
  std::span<const double> first(std::size_t count);  // valid until the next call

 private:
  std::span<const double> map_;
  Draws& draws_;
  std::vector<double> drawn_;
};

}  // namespace salbench
