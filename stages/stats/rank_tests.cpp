// SPDX-License-Identifier: GPL-3.0-or-later
// The conventions are those of SciPy (1.11 and later for the signed ranks: older versions take the exact
// distribution for tied differences too, where it does not hold). One departure: if all values agree, SciPy
// gives NaN or an error; here p = 1, since nothing speaks against the hypothesis.
#include "stages/stats/rank_tests.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "stages/core/check.h"
#include "stages/stats/ranks.h"

namespace salbench {
namespace {

constexpr std::size_t kMaxExactPairs = 50;

double two_sided(double z) { return std::erfc(std::abs(z) / std::numbers::sqrt2); }

// P(the sum of the positive ranks 1..n <= sum), each rank being positive with probability one half. The
// number of sign patterns with a given sum is counted rank by rank: at most 2^50, exact in 64 bits.
double signed_rank_tail(std::size_t n, std::size_t sum) {
  std::vector<std::uint64_t> patterns(sum + 1, 0);
  patterns[0] = 1;
  for (std::size_t rank = 1; rank <= std::min(n, sum); ++rank)
    for (std::size_t s = sum; s >= rank; --s) patterns[s] += patterns[s - rank];
  std::uint64_t total = 0;
  for (const std::uint64_t count : patterns) total += count;
  return std::ldexp(static_cast<double>(total), -static_cast<int>(n));
}

double signed_rank_z(double n, double statistic, double ties) {
  const double mean = n * (n + 1) / 4;
  const double variance = (n * (n + 1) * (2 * n + 1) - ties / 2) / 24;
  return (statistic - mean) / std::sqrt(variance);  // n >= 1: ties never take all of the variance
}

}  // namespace

RankSum rank_sum_test(std::span<const double> x, std::span<const double> y, TieVariance ties) {
  std::vector<double> pooled;
  pooled.reserve(x.size() + y.size());
  const auto is_defined = [](double value) { return !std::isnan(value); };
  std::copy_if(x.begin(), x.end(), std::back_inserter(pooled), is_defined);
  const std::size_t size_x = pooled.size();
  std::copy_if(y.begin(), y.end(), std::back_inserter(pooled), is_defined);
  const auto n_x = static_cast<double>(size_x), n_y = static_cast<double>(pooled.size() - size_x);

  RankSum result;
  result.n_x = static_cast<std::int64_t>(size_x);
  result.n_y = static_cast<std::int64_t>(pooled.size() - size_x);
  if (result.n_x == 0 || result.n_y == 0) return result;

  const Ranks ranks = midranks(pooled);
  double sum_x = 0;
  for (std::size_t i = 0; i < size_x; ++i) sum_x += ranks.rank[i];
  result.u = sum_x - n_x * (n_x + 1) / 2;

  const double n = n_x + n_y;
  double spread = n + 1;
  if (ties == TieVariance::corrected) spread -= ranks.ties / (n * (n - 1));
  const double variance = n_x * n_y / 12 * spread;
  result.z = variance > 0 ? (result.u - n_x * n_y / 2) / std::sqrt(variance) : 0;
  result.p_value = two_sided(result.z);
  return result;
}

SignedRank signed_rank_test(std::span<const double> x, std::span<const double> y) {
  CHECK_EQ(x.size(), y.size());
  SignedRank result;
  std::vector<double> sizes;
  std::vector<bool> positive;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (std::isnan(x[i]) || std::isnan(y[i])) continue;
    if (x[i] == y[i]) {  // also if both are infinite, and have no difference
      ++result.n_equal;
      continue;
    }
    const double difference = x[i] - y[i];
    sizes.push_back(std::abs(difference));
    positive.push_back(difference > 0);
  }
  result.n = static_cast<std::int64_t>(sizes.size());
  if (result.n + result.n_equal == 0) return result;
  if (result.n == 0) {
    result.statistic = 0;
    result.p_value = 1;
    return result;
  }

  const Ranks ranks = midranks(sizes);
  double sum_negative = 0;
  for (std::size_t i = 0; i < sizes.size(); ++i)
    (positive[i] ? result.sum_positive : sum_negative) += ranks.rank[i];
  result.statistic = std::min(result.sum_positive, sum_negative);
  result.exact = sizes.size() <= kMaxExactPairs && result.n_equal == 0 && ranks.ties == 0;
  result.p_value =
      result.exact
          ? std::min(1.0, 2 * signed_rank_tail(sizes.size(), static_cast<std::size_t>(result.statistic)))
          : two_sided(signed_rank_z(static_cast<double>(sizes.size()), result.statistic, ranks.ties));
  return result;
}

}  // namespace salbench
