// SPDX-License-Identifier: GPL-3.0-or-later
// Summaries of a sample of scores. NaN is a score that is undefined for its item: left out, and counted.
#pragma once

#include <cstdint>
#include <limits>
#include <span>

namespace salbench {

inline constexpr double kConfidence = 0.95;        // of every interval in the reports
inline constexpr double kLevel = 1 - kConfidence;  // of every test

struct Interval {
  double low = std::numeric_limits<double>::quiet_NaN();  // NaN where there is none
  double high = std::numeric_limits<double>::quiet_NaN();
};

struct Summary {
  std::int64_t n = 0;                                         // values that are defined
  std::int64_t n_undefined = 0;                               // values that are NaN
  double mean = std::numeric_limits<double>::quiet_NaN();     // NaN if n = 0
  double sd = std::numeric_limits<double>::quiet_NaN();       // of the sample, by n - 1; NaN if n < 2
  double ci_low = std::numeric_limits<double>::quiet_NaN();   // 95 % interval of the mean; NaN if n < 2
  double ci_high = std::numeric_limits<double>::quiet_NaN();  // likewise
};

// Mean, standard deviation and Student's confidence interval mean -+ t(n - 1) sd / sqrt(n).
Summary summarise(std::span<const double> values);

// The interval of the mean; none where the values do not vary: a width of 0 says that they are few or equal,
// not that the mean is known.
Interval student_interval(const Summary& summary);

// The value below which a fraction q of the defined values lies, 0 <= q <= 1, linear between the values at
// q (n - 1); NaN if no value is defined. [hyndman1996, definition 7]
double quantile(std::span<const double> values, double q);
double quantile_in_place(std::span<double> sample, double q);  // of values that are not NaN; reorders them
double median(std::span<const double> values);

}  // namespace salbench
