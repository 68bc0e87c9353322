// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/stats/distributions.h"

#include <cmath>
#include <numbers>

#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>

namespace salbench {

namespace math = boost::math;

double normal_cdf(double z) { return std::erfc(-z / std::numbers::sqrt2) / 2; }

double normal_quantile(double p) { return math::quantile(math::normal(), p); }

double student_upper_quantile(double tail, double degrees_of_freedom) {
  return math::quantile(math::complement(math::students_t(degrees_of_freedom), tail));
}

double student_upper_tail(double t, double degrees_of_freedom) {
  if (std::isinf(t)) return t > 0 ? 0 : 1;
  return math::cdf(math::complement(math::students_t(degrees_of_freedom), t));
}

double student_two_sided(double t, double degrees_of_freedom) {
  return 2 * student_upper_tail(std::abs(t), degrees_of_freedom);
}

}  // namespace salbench
