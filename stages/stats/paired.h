// SPDX-License-Identifier: GPL-3.0-or-later
// Two models on the same units: how large their difference is, how sure, and whether it is small enough to
// call them the same. Differences are a - b.
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "stages/stats/resampling.h"

namespace salbench {

// NaN where there are too few units: one for the mean, two for everything else. The values have no NaN.
struct PairedComparison {
  std::int64_t n = 0;  // units
  double mean_difference = std::numeric_limits<double>::quiet_NaN();
  double deviation = std::numeric_limits<double>::quiet_NaN();  // of the differences, by n - 1
  Interval interval = {};                                 // Student, 95 %; none if all agree
  double t_p = std::numeric_limits<double>::quiet_NaN();  // two-sided; below .05 where the
                                                          // interval leaves out 0
  Interval equivalence_interval = {};  // Student, 90 %: within +-margin, the two are equivalent at 0.05
  double d_z = std::numeric_limits<double>::quiet_NaN();            // Cohen: mean over deviation
  double rank_biserial = std::numeric_limits<double>::quiet_NaN();  // of matched pairs, in [-1, 1]
  double superiority = std::numeric_limits<double>::quiet_NaN();    // P(a > b) + P(a = b) / 2
  Interval superiority_interval = {};                               // Wilson, 95 %
};

// [cohen1988] [kerby2014] [agarwal2021]
PairedComparison compare_paired(std::span<const double> a, std::span<const double> b);

// Wilson's score interval of a share of n independent cases, 95 %. n > 0. [wilson1927]
Interval wilson_interval(double share, std::int64_t n);

// Two one-sided t-tests: p-value of the hypothesis that the mean of the differences is at least `margin` away
// from 0. At 0.05 it is rejected exactly where the 90 % interval lies within the margins.
// [schuirmann1987] [lakens2017]
struct Equivalence {
  double p_value = std::numeric_limits<double>::quiet_NaN();  // NaN for fewer than two values
  Interval interval = {};                                     // Student, 90 %
};
Equivalence test_equivalence(std::span<const double> differences, double margin);  // margin > 0

// Number of units with which a paired t-test at 0.05 finds a mean difference with probability 0.8, the
// deviation of the differences being known, and the smallest difference that n units show. By the
// noncentral t distribution. [cohen1988]
inline constexpr double kPower = 0.8;
double power_of_paired_test(double difference, double deviation, double n);
double detectable_difference(double deviation, std::int64_t n);     // NaN for n < 2
std::int64_t units_to_detect(double difference, double deviation);  // 2 at least; -1 beyond 10^9

}  // namespace salbench
