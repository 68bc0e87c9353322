// SPDX-License-Identifier: GPL-3.0-or-later
// Wilcoxon's two tests, two-sided. NaN is an undefined score: it is left out, with its partner in a pair.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>

#include "stages/core/options.h"

namespace salbench {

// Equal values always share their mean rank, which also reduces the variance of the statistic.
enum class TieVariance {
  ignored,   // as if there were no ties: the test errs on the safe side (SciPy's ranksums)
  corrected  // reduced for ties (SciPy's mannwhitneyu, asymptotic and without continuity correction)
};

template <>
struct EnumNames<TieVariance> {
  static constexpr std::array<std::string_view, 2> names = {"ignored", "corrected"};
};

// All NaN if a sample is empty; z = 0 and p = 1 if all values of both are equal.
struct RankSum {
  std::int64_t n_x = 0, n_y = 0;                              // values used
  double u = std::numeric_limits<double>::quiet_NaN();        // pairs with x above y, ties one half
  double z = std::numeric_limits<double>::quiet_NaN();        // of u, under the normal approximation
  double p_value = std::numeric_limits<double>::quiet_NaN();  // two-sided
};

// Do two independent samples come from the same distribution? [wilcoxon1945, mann1947]
RankSum rank_sum_test(std::span<const double> x, std::span<const double> y,
                      TieVariance ties = TieVariance::ignored);

// NaN if there are no pairs; p = 1 if all pairs are equal.
struct SignedRank {
  std::int64_t n = 0;                                           // pairs that differ
  std::int64_t n_equal = 0;                                     // pairs that do not differ: left out
  bool exact = false;                                           // false: the normal approximation
  double sum_positive = 0;                                      // of the ranks of positive differences
  double statistic = std::numeric_limits<double>::quiet_NaN();  // the smaller of both sums of ranks
  double p_value = std::numeric_limits<double>::quiet_NaN();    // two-sided
};

// Are the differences of paired samples of one length symmetric about 0? Exact for at most 50 pairs of which
// none is equal and no two differ by the same amount; else normal, corrected for ties. [wilcoxon1945]
SignedRank signed_rank_test(std::span<const double> x, std::span<const double> y);

}  // namespace salbench
