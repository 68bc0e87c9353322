// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/stats/paired.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <boost/math/distributions/non_central_t.hpp>

#include "stages/core/check.h"
#include "stages/stats/distributions.h"
#include "stages/stats/rank_tests.h"
#include "stages/stats/summary.h"

namespace salbench {
namespace {

// Mean over its standard error; infinite where all values agree on another mean than `hypothesis`.
double t_statistic(const Summary& summary, double hypothesis) {
  const double away = summary.mean - hypothesis;
  if (away == 0) return 0;
  return away / (summary.sd / std::sqrt(static_cast<double>(summary.n)));
}

// The interval that two one-sided tests at 0.05 compare with their margins.
Interval interval_90(const Summary& summary) {
  const double half = student_upper_quantile(kLevel, static_cast<double>(summary.n - 1)) * summary.sd /
                      std::sqrt(static_cast<double>(summary.n));
  return {summary.mean - half, summary.mean + half};
}

// Share of wins, draws one half.
double share_above(std::span<const double> differences) {
  double twice = 0;
  for (const double d : differences) twice += (d > 0 ? 1 : 0) + (d >= 0 ? 1 : 0);
  return twice / (2 * static_cast<double>(differences.size()));
}

}  // namespace

PairedComparison compare_paired(std::span<const double> a, std::span<const double> b) {
  CHECK_EQ(a.size(), b.size());
  std::vector<double> differences(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) differences[i] = a[i] - b[i];
  const Summary summary = summarise(differences);
  CHECK_EQ(summary.n_undefined, 0);
  PairedComparison result;
  result.n = summary.n;
  result.mean_difference = summary.mean;
  if (summary.n < 2) return result;
  result.deviation = summary.sd;
  const SignedRank signed_rank = signed_rank_test(a, b);
  const double all_ranks = static_cast<double>(signed_rank.n) * (static_cast<double>(signed_rank.n) + 1) / 2;
  result.rank_biserial = all_ranks > 0 ? 2 * signed_rank.sum_positive / all_ranks - 1 : 0;
  result.superiority = share_above(differences);
  result.superiority_interval = wilson_interval(result.superiority, summary.n);
  result.t_p = student_two_sided(t_statistic(summary, 0), static_cast<double>(summary.n - 1));
  if (!(summary.sd > 0)) return result;
  result.interval = student_interval(summary);
  result.equivalence_interval = interval_90(summary);
  result.d_z = summary.mean / summary.sd;
  return result;
}

Interval wilson_interval(double share, std::int64_t n) {
  CHECK_LT(0, n);
  const auto cases = static_cast<double>(n);
  const double z = normal_quantile(1 - kLevel / 2), z2 = z * z;
  const double centre = (share + z2 / (2 * cases)) / (1 + z2 / cases);
  const double half =
      z / (1 + z2 / cases) * std::sqrt(share * (1 - share) / cases + z2 / (4 * cases * cases));
  return {std::max(0.0, centre - half), std::min(1.0, centre + half)};
}

Equivalence test_equivalence(std::span<const double> differences, double margin) {
  CHECK_LT(0.0, margin);
  const Summary summary = summarise(differences);
  CHECK_EQ(summary.n_undefined, 0);
  if (summary.n < 2) return {};
  const auto freedom = static_cast<double>(summary.n - 1);
  return {std::max(student_upper_tail(t_statistic(summary, -margin), freedom),
                   student_upper_tail(-t_statistic(summary, margin), freedom)),
          interval_90(summary)};
}

double power_of_paired_test(double difference, double deviation, double n) {
  const double freedom = n - 1, noncentrality = std::abs(difference) / deviation * std::sqrt(n);
  const double critical = student_upper_quantile(kLevel / 2, freedom);
  constexpr double kCertain = 30;  // beyond, the distribution's series do not converge
  if (noncentrality - critical > kCertain) return 1;
  if (noncentrality == 0) return kLevel;
  const boost::math::non_central_t distribution(freedom, noncentrality);
  return boost::math::cdf(boost::math::complement(distribution, critical)) +
         boost::math::cdf(distribution, -critical);
}

double detectable_difference(double deviation, std::int64_t n) {
  if (n < 2 || !(deviation > 0)) return std::numeric_limits<double>::quiet_NaN();
  double low = 0, high = deviation;  // the power rises with the difference
  while (power_of_paired_test(high, deviation, static_cast<double>(n)) < kPower) high *= 2;
  for (int step = 0; step < 60; ++step) {
    const double middle = (low + high) / 2;
    (power_of_paired_test(middle, deviation, static_cast<double>(n)) < kPower ? low : high) = middle;
  }
  return high;
}

std::int64_t units_to_detect(double difference, double deviation) {
  constexpr std::int64_t kMost = 1'000'000'000;
  const auto enough = [&](std::int64_t n) {
    return power_of_paired_test(difference, deviation, static_cast<double>(n)) >= kPower;
  };
  std::int64_t low = 1, high = 2;
  while (!enough(high)) {
    if (high >= kMost) return -1;
    low = std::exchange(high, std::min(2 * high, kMost));
  }
  while (high - low > 1) {
    const std::int64_t middle = low + (high - low) / 2;
    (enough(middle) ? high : low) = middle;
  }
  return high;
}

}  // namespace salbench
