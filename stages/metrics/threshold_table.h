// SPDX-License-Identifier: GPL-3.0-or-later
// For many numbers: how many thresholds of a sorted list each one reaches. Table look-up instead of search.
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

// For random numbers, and ascending thresholds in [0, 1] of any spacing. The table divides [0, 1) into equal
// cells; most cells have no threshold within, and the cell alone gives the count.
class ThresholdTable {
 public:
  // `numbers`: how many will be looked up at a time; the size of the table follows from it.
  ThresholdTable(std::vector<double> thresholds, std::size_t numbers)
      : thresholds_(std::move(thresholds)),
        // A power of two: a number's upper bits are its cell.
        in_cell_(std::clamp(std::bit_ceil(4 * numbers), kLeastCells, kMostCells)) {
    const auto cells = static_cast<double>(in_cell_.size());
    std::size_t filled = 0;
    for (std::size_t reached = 0; reached < thresholds_.size(); ++reached) {
      // All numbers of the cell that begins at a threshold reach it.
      const auto begun = static_cast<std::size_t>(thresholds_[reached] * cells);
      const bool on_border = static_cast<double>(begun) == thresholds_[reached] * cells;
      const std::size_t cell = on_border ? begun : begun + 1;
      fill(filled, cell, static_cast<std::int32_t>(reached));
      if (cell > filled && !on_border) in_cell_[cell - 1] = -1 - static_cast<std::int32_t>(reached);
      filled = cell;
    }
    fill(filled, in_cell_.size(), static_cast<std::int32_t>(thresholds_.size()));
    thresholds_.push_back(std::numeric_limits<double>::infinity());
  }

  // A loop that stores to memory takes a copy, so that the compiler need not read these fields again each
  // time.
  struct LookUp {
    const std::int32_t* in_cell;
    const double* thresholds;
    unsigned shift;

    // The number is one of Rng::next, and stands for uniform_of(number).
    std::size_t operator()(std::uint64_t number) const {
      const std::int32_t known = in_cell[number >> shift];
      if (known >= 0) return static_cast<std::size_t>(known);
      auto reached = static_cast<std::size_t>(-1 - known);
      for (const double u = uniform_of(number); thresholds[reached] <= u;) ++reached;
      return reached;
    }
  };
  LookUp look_up() const {
    return {in_cell_.data(), thresholds_.data(),
            64 - static_cast<unsigned>(std::countr_zero(in_cell_.size()))};
  }

 private:
  static constexpr std::size_t kLeastCells = 64, kMostCells = 1024;

  void fill(std::size_t first, std::size_t end, std::int32_t reached) {
    for (std::size_t cell = first; cell < end; ++cell) in_cell_[cell] = reached;
  }

  std::vector<double> thresholds_;  // and infinity
  std::vector<std::int32_t>
      in_cell_;  // [cell]: count, or -1 - count at its beginning if it has a threshold within
};

// For values from 0 to `largest`, and evenly spaced thresholds from 0 to `largest` > 0.
class EvenThresholds {
 public:
  EvenThresholds(std::vector<double> thresholds, double largest)
      : per_unit_(std::min(static_cast<double>(thresholds.size() - 1) / largest, kFinite)),
        thresholds_(std::move(thresholds)) {
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
  static constexpr double kFinite = std::numeric_limits<double>::max();  // of a subnormal `largest`

  double per_unit_;
  std::vector<double> thresholds_;
};

}  // namespace salbench
