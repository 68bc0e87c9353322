// SPDX-License-Identifier: GPL-3.0-or-later
// Ranks of a sample, as the rank tests and Spearman's correlation need them.
#pragma once

#include <span>
#include <vector>

namespace salbench {

struct Ranks {
  std::vector<double> rank;  // n, from 1; equal values share the mean of their ranks
  double ties = 0;           // sum of t^3 - t over the groups of t equal values; 0 without ties
};

Ranks midranks(std::span<const double> values);  // none is NaN, which is checked

}  // namespace salbench
