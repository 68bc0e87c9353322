// SPDX-License-Identifier: GPL-3.0-or-later
// How many of some ascending positions a number has reached, for many numbers: looked up, not searched for.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "stages/metrics/draws.h"

namespace salbench {

// How many of some ascending positions in [0, 1] a random number has reached, looked up in equal cells of
// [0, 1): most of them have no position within.
class Reached {
 public:
  // Worth its making for so many numbers at a time.
  Reached(std::vector<double> from, std::size_t numbers)
      : from_(std::move(from)),
        // A power of two: a number's upper bits are its cell.
        in_cell_(std::clamp(std::bit_ceil(4 * numbers), kLeastCells, kMostCells)) {
    const auto cells = static_cast<double>(in_cell_.size());
    std::size_t filled = 0;
    for (std::size_t reached = 0; reached < from_.size(); ++reached) {
      // A position on a border has been reached by all of the cell that begins there.
      const auto begun = static_cast<std::size_t>(from_[reached] * cells);
      const bool on_border = static_cast<double>(begun) == from_[reached] * cells;
      const std::size_t cell = on_border ? begun : begun + 1;
      fill(filled, cell, static_cast<std::int32_t>(reached));
      if (cell > filled && !on_border) in_cell_[cell - 1] = -1 - static_cast<std::int32_t>(reached);
      filled = cell;
    }
    fill(filled, in_cell_.size(), static_cast<std::int32_t>(from_.size()));
    from_.push_back(std::numeric_limits<double>::infinity());
  }

  // A loop that stores to memory takes a copy, so that the compiler need not read these fields again each
  // time.
  struct LookUp {
    const std::int32_t* in_cell;
    const double* from;
    unsigned shift;

    // The number is one of Rng::next, and stands for uniform_of(number).
    std::size_t operator()(std::uint64_t number) const {
      const std::int32_t known = in_cell[number >> shift];
      if (known >= 0) return static_cast<std::size_t>(known);
      auto reached = static_cast<std::size_t>(-1 - known);
      for (const double u = uniform_of(number); from[reached] <= u;) ++reached;
      return reached;
    }
  };
  LookUp look_up() const {
    return {in_cell_.data(), from_.data(), 64 - static_cast<unsigned>(std::countr_zero(in_cell_.size()))};
  }

 private:
  static constexpr std::size_t kLeastCells = 64, kMostCells = 1024;

  void fill(std::size_t first, std::size_t end, std::int32_t reached) {
    for (std::size_t cell = first; cell < end; ++cell) in_cell_[cell] = reached;
  }

  std::vector<double> from_;           // and infinity
  std::vector<std::int32_t> in_cell_;  // -1 - the number at its beginning where it has one within
};

// How many even thresholds up to `largest` > 0 a value from 0 to `largest` reaches.
class EvenReached {
 public:
  EvenReached(std::vector<double> thresholds, double largest)
      : per_unit_(static_cast<double>(thresholds.size() - 1) / largest), thresholds_(std::move(thresholds)) {
    thresholds_.push_back(std::numeric_limits<double>::infinity());
  }

  struct LookUp {
    const double* thresholds;
    double per_unit;
    std::size_t most;

    std::size_t operator()(double value) const {
      auto reached = static_cast<std::size_t>(value * per_unit) + 1;
      reached = std::min(reached, most);
      // Rounding may put the product on the wrong side of a threshold: the threshold itself decides. The
      // search ends, because the first threshold is 0 and the last is infinite.
      while (thresholds[reached] <= value) ++reached;
      while (thresholds[reached - 1] > value) --reached;
      return reached;
    }
  };
  LookUp look_up() const { return {thresholds_.data(), per_unit_, thresholds_.size() - 1}; }

 private:
  double per_unit_;
  std::vector<double> thresholds_;
};

}  // namespace salbench
