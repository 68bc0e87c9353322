// SPDX-License-Identifier: GPL-3.0-or-later
// The normal and Student's distribution, as tests and intervals need them.
#pragma once

namespace salbench {

double normal_cdf(double z);
double normal_quantile(double p);  // 0 < p < 1

// Degrees of freedom > 0.
double student_upper_quantile(double tail,
                              double degrees_of_freedom);        // t with P(T > t) = tail; 0 < tail < 1
double student_upper_tail(double t, double degrees_of_freedom);  // P(T > t)
double student_two_sided(double t, double degrees_of_freedom);   // P(|T| > |t|)

}  // namespace salbench
