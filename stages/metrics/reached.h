// SPDX-License-Identifier: GPL-3.0-or-later
// How many of some ascending positions a number has reached, for many numbers: looked up, not searched for.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace salbench {

// How many of some ascending positions in [0, 1] a number in [0, 1) has reached, looked up in equal cells:
// most of them have no position within.
class Reached {
 public:
  // Worth its making for so many numbers at a time.
  Reached(std::vector<double> from, std::size_t numbers)
      : from_(std::move(from)),
        cells_(static_cast<double>(std::clamp(std::bit_ceil(4 * numbers), kLeastCells, kMostCells))),
        in_cell_(static_cast<std::size_t>(cells_)) {
    std::size_t filled = 0;
    for (std::size_t reached = 0; reached < from_.size(); ++reached) {
      // A position on a border has been reached by all of the cell that begins there.
      const auto cell = static_cast<std::size_t>(std::ceil(from_[reached] * cells_));
      fill(filled, cell, static_cast<std::int32_t>(reached));
      if (cell > filled && from_[reached] * cells_ < static_cast<double>(cell))
        in_cell_[cell - 1] = -1 - static_cast<std::int32_t>(reached);
      filled = cell;
    }
    fill(filled, in_cell_.size(), static_cast<std::int32_t>(from_.size()));
    from_.push_back(std::numeric_limits<double>::infinity());
  }

  std::size_t operator()(double u) const {
    const std::int32_t known = in_cell_[static_cast<std::size_t>(u * cells_)];
    if (known >= 0) return static_cast<std::size_t>(known);
    auto reached = static_cast<std::size_t>(-1 - known);
    while (from_[reached] <= u) ++reached;
    return reached;
  }

 private:
  static constexpr std::size_t kLeastCells = 64, kMostCells = 1024;

  void fill(std::size_t first, std::size_t end, std::int32_t reached) {
    for (std::size_t cell = first; cell < end; ++cell) in_cell_[cell] = reached;
  }

  std::vector<double> from_;           // and infinity
  double cells_;                       // a power of two: u * cells_ stays below it
  std::vector<std::int32_t> in_cell_;  // -1 - the number at its beginning where it has one within
};

// How many even thresholds up to `largest` > 0 a value from 0 to `largest` reaches.
class EvenReached {
 public:
  EvenReached(std::vector<double> thresholds, double largest)
      : per_unit_(static_cast<double>(thresholds.size() - 1) / largest), thresholds_(std::move(thresholds)) {
    thresholds_.push_back(std::numeric_limits<double>::infinity());
  }

  std::size_t operator()(double value) const {
    auto reached = static_cast<std::size_t>(value * per_unit_) + 1;
    reached = std::min(reached, thresholds_.size() - 1);
    // Where the product is rounded to the wrong side, the threshold decides. The first one is 0, the last
    // infinite.
    while (thresholds_[reached] <= value) ++reached;
    while (thresholds_[reached - 1] > value) --reached;
    return reached;
  }

 private:
  double per_unit_;
  std::vector<double> thresholds_;
};

}  // namespace salbench
