// SPDX-License-Identifier: GPL-3.0-or-later
// The bound is single-step: the 95 % quantile, over the resamples, of the largest |difference - resampled
// difference| in standard errors. Resampling knows the deviation of n units as that of the sample itself,
// which is too small by sqrt((n - 1) / n), and takes it for known; both are put right by the ratio of
// Student's quantile to the normal one, which makes the bound of a single pair Student's own.
#include "stages/stats/ranking.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "stages/core/check.h"
#include "stages/stats/distributions.h"
#include "stages/stats/summary.h"

namespace salbench {
namespace {

struct Pair {
  std::size_t a, b;
  double difference, error;  // its mean over the units, and the standard error of that
};

std::vector<Pair> all_pairs(const Columns& scores) {
  std::vector<Pair> pairs;
  std::vector<double> differences(scores.units());
  for (std::size_t a = 0; a < scores.count; ++a)
    for (std::size_t b = a + 1; b < scores.count; ++b) {
      for (std::size_t u = 0; u < scores.units(); ++u) differences[u] = scores.at(u, a) - scores.at(u, b);
      const Summary summary = summarise(differences);
      pairs.push_back({a, b, summary.mean, summary.sd / std::sqrt(static_cast<double>(summary.n))});
    }
  return pairs;
}

double critical_value(const std::vector<Pair>& pairs, const Columns& resampled, std::size_t units) {
  std::vector<double> largest(resampled.units(), 0.0);
  for (std::size_t r = 0; r < largest.size(); ++r)
    for (const Pair& pair : pairs) {
      if (!(pair.error > 0)) continue;
      const double difference = resampled.at(r, pair.a) - resampled.at(r, pair.b);
      largest[r] = std::max(largest[r], std::abs(difference - pair.difference) / pair.error);
    }
  const auto n = static_cast<double>(units);
  constexpr double kTail = (1 - kConfidence) / 2;
  const double for_unknown_deviation =
      std::sqrt(n / (n - 1)) * student_upper_quantile(kTail, n - 1) / normal_quantile(1 - kTail);
  return quantile(largest, kConfidence) * for_unknown_deviation;
}

// Share of the resamples in which each model has the best mean; several best ones share it.
std::vector<double> shares_of_first(const Columns& resampled, bool higher_is_better) {
  std::vector<double> shares(resampled.count, 0.0);
  std::vector<std::size_t> best;
  for (std::size_t r = 0; r < resampled.units(); ++r) {
    best.clear();
    for (std::size_t m = 0; m < resampled.count; ++m) {
      const double ahead = best.empty() ? 0 : resampled.at(r, m) - resampled.at(r, best.front());
      if (higher_is_better ? ahead > 0 : ahead < 0) best.clear();
      if (best.empty() || ahead == 0) best.push_back(m);
    }
    for (const std::size_t m : best) shares[m] += 1 / static_cast<double>(best.size());
  }
  for (double& share : shares) share /= static_cast<double>(resampled.units());
  return shares;
}

// Splits the groups in which two that differ are together, and drops those within another one.
void separate(std::vector<std::set<std::size_t>>& groups, std::size_t i, std::size_t j) {
  std::vector<std::set<std::size_t>> split;
  for (const std::set<std::size_t>& group : groups) {
    if (!group.contains(i) || !group.contains(j)) {
      split.push_back(group);
      continue;
    }
    for (const std::size_t left_out : {i, j}) {
      split.push_back(group);
      split.back().erase(left_out);
    }
  }
  groups.clear();
  for (std::size_t g = 0; g < split.size(); ++g) {
    const auto holds = [&](std::size_t other) {
      return other != g && std::ranges::includes(split[other], split[g]) &&
             (split[other].size() > split[g].size() || other < g);
    };
    bool within_another = false;
    for (std::size_t other = 0; other < split.size() && !within_another; ++other)
      within_another = holds(other);
    if (!within_another) groups.push_back(split[g]);
  }
}

}  // namespace

std::vector<std::string> compact_letters(const std::vector<std::vector<bool>>& differ,
                                         std::span<const std::size_t> order) {
  const std::size_t n = order.size();  // below, items are numbered by their place in the order
  std::vector<std::set<std::size_t>> groups(1);
  for (std::size_t i = 0; i < n; ++i) groups[0].insert(i);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j)
      if (differ[order[i]][order[j]]) separate(groups, i, j);
  std::ranges::sort(groups);
  std::vector<std::string> letters(n);
  for (std::size_t g = 0; g < groups.size(); ++g)
    for (const std::size_t i : groups[g]) {
      // a to z, then aa', ab', ...: no table has so many groups, but none may be ambiguous.
      const auto letter = static_cast<char>('a' + g % 26);
      letters[order[i]] += std::string(1, letter) + std::string(g / 26, '\'');
    }
  return letters;
}

Ranking rank_models(const Columns& scores, const Columns& resampled, bool higher_is_better) {
  const std::size_t k = scores.count;
  Ranking ranking{std::vector<ModelRank>(k), std::numeric_limits<double>::quiet_NaN()};
  if (scores.units() == 0) return ranking;
  const std::vector<double> means = scores.means();
  const auto better = [&](double x, double y) { return higher_is_better ? x > y : x < y; };
  for (std::size_t m = 0; m < k; ++m) {
    ranking.models[m].mean = means[m];
    ranking.models[m].rank =
        1 + std::ranges::count_if(means, [&](double other) { return better(other, means[m]); });
  }
  if (scores.units() < 2) return ranking;
  CHECK_EQ(k, resampled.count);

  const std::vector<Pair> pairs = all_pairs(scores);
  ranking.critical = critical_value(pairs, resampled, scores.units());
  const std::vector<double> first = shares_of_first(resampled, higher_is_better);
  std::vector<std::vector<bool>> differ(k, std::vector<bool>(k, false));
  for (std::size_t m = 0; m < k; ++m) {
    ranking.models[m].rank_low = 1;
    ranking.models[m].rank_high = static_cast<std::int64_t>(k);
    ranking.models[m].first = first[m];
  }
  for (const Pair& pair : pairs) {
    if (!(std::abs(pair.difference) > ranking.critical * pair.error)) continue;
    differ[pair.a][pair.b] = differ[pair.b][pair.a] = true;
    const bool a_is_better = better(pair.difference, 0);
    ++ranking.models[a_is_better ? pair.b : pair.a].rank_low;
    --ranking.models[a_is_better ? pair.a : pair.b].rank_high;
  }
  std::vector<std::size_t> order(k);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return better(means[a], means[b]); });
  const std::vector<std::string> letters = compact_letters(differ, order);
  for (std::size_t m = 0; m < k; ++m) ranking.models[m].letters = letters[m];
  return ranking;
}

double kendall_tau(std::span<const double> x, std::span<const double> y) {
  CHECK_EQ(x.size(), y.size());
  const auto sign = [](double d) { return (d > 0 ? 1 : 0) - (d < 0 ? 1 : 0); };
  double agreement = 0, untied_x = 0, untied_y = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    for (std::size_t j = i + 1; j < x.size(); ++j) {
      const int in_x = sign(x[i] - x[j]), in_y = sign(y[i] - y[j]);
      agreement += in_x * in_y;
      untied_x += in_x * in_x;
      untied_y += in_y * in_y;
    }
  return agreement / std::sqrt(untied_x * untied_y);  // 0 / 0 where one is constant
}

}  // namespace salbench
