// SPDX-License-Identifier: GPL-3.0-or-later
// Random cases against SciPy (package python3-scipy): both sides compute, and the numbers are compared.
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "stages/core/rng.h"
#include "stages/stats/correlation.h"
#include "stages/stats/distance.h"
#include "stages/stats/multiple.h"
#include "stages/stats/paired.h"
#include "stages/stats/rank_tests.h"
#include "stages/stats/ranking.h"
#include "stages/stats/summary.h"

namespace salbench {
namespace {

using Sample = std::vector<double>;

struct Case {
  std::string operation;
  std::vector<Sample> samples;
  Sample ours;
};

Sample draw(Rng& rng, std::size_t n, double step) {  // step > 0: rounded to it, so that values tie
  const double shift = rng.normal(), scale = std::exp(rng.normal());
  Sample sample(n);
  for (double& value : sample) {
    value = shift + scale * rng.normal();
    if (step > 0) value = step * std::round(value / step);
  }
  return sample;
}

Histogram random_counts(Rng& rng) {
  Histogram counts;
  for (double& count : counts) count = static_cast<double>(rng.below(9));
  return counts;
}

void add_two_sample_cases(std::vector<Case>& cases, Rng& rng, double step) {
  const Sample x = draw(rng, 3 + rng.below(80), step), y = draw(rng, 3 + rng.below(80), step);
  const RankSum plain = rank_sum_test(x, y);
  cases.push_back({"rank_sum", {x, y}, {plain.z, plain.p_value}});
  const RankSum corrected = rank_sum_test(x, y, TieVariance::corrected);
  cases.push_back({"rank_sum_corrected", {x, y}, {corrected.u, corrected.p_value}});
}

void add_paired_cases(std::vector<Case>& cases, Rng& rng, double step) {
  const std::size_t n = 5 + rng.below(100);
  const Sample x = draw(rng, n, step), y = draw(rng, n, step);
  cases.push_back({"pearson", {x, y}, {pearson(x, y)}});
  cases.push_back({"spearman", {x, y}, {spearman(x, y)}});
  const SignedRank test = signed_rank_test(x, y);
  cases.push_back({"signed_rank", {x, y}, {test.statistic, test.p_value, static_cast<double>(test.exact)}});
  const PairedComparison pair = compare_paired(x, y);
  cases.push_back(
      {"paired",
       {x, y},
       {pair.mean_difference, pair.interval.low, pair.interval.high, pair.t_p, pair.d_z, pair.rank_biserial,
        pair.superiority, pair.superiority_interval.low, pair.superiority_interval.high}});
  const double margin = std::exp(rng.normal());
  const Equivalence equivalence = test_equivalence(x, margin);
  cases.push_back({"equivalence",
                   {x, {margin}},
                   {equivalence.p_value, equivalence.interval.low, equivalence.interval.high}});
  cases.push_back({"kendall", {x, y}, {kendall_tau(x, y)}});
  const double effect = rng.uniform();
  cases.push_back({"power",
                   {{effect, static_cast<double>(n)}},
                   {power_of_paired_test(effect, 1, static_cast<double>(n))}});
}

void add_one_sample_cases(std::vector<Case>& cases, Rng& rng, double step) {
  const Sample x = draw(rng, 2 + rng.below(60), step);
  const Summary summary = summarise(x);
  cases.push_back({"summary", {x}, {summary.mean, summary.sd, summary.ci_low, summary.ci_high}});
  const double q = rng.uniform();
  cases.push_back(
      {"quantile", {x, {0, q, 0.5, 1}}, {quantile(x, 0), quantile(x, q), median(x), quantile(x, 1)}});
  Sample p(1 + rng.below(20));
  for (double& value : p) value = std::pow(rng.uniform(), 4);
  if (step > 0) p.push_back(p.front());
  cases.push_back({"holm", {p}, holm_adjusted(p)});
}

std::vector<Case> random_cases() {
  Rng rng(1, "scipy", "");
  std::vector<Case> cases;
  for (int round = 0; round < 60; ++round) {
    const double step = round % 3 == 0 ? 0 : 0.25 * (round % 3);
    add_one_sample_cases(cases, rng, step);
    add_two_sample_cases(cases, rng, step);
    add_paired_cases(cases, rng, step);
    const Histogram a = random_counts(rng), b = random_counts(rng);
    cases.push_back(
        {"kolmogorov_smirnov", {{a.begin(), a.end()}, {b.begin(), b.end()}}, {kolmogorov_smirnov(a, b)}});
  }
  return cases;
}

void write(const std::vector<Case>& cases, const std::filesystem::path& path) {
  std::ofstream file(path);
  file << std::setprecision(17);
  for (const Case& c : cases) {
    file << c.operation;
    for (const Sample& sample : c.samples) {
      file << " |";
      for (const double value : sample) file << ' ' << value;
    }
    file << '\n';
  }
}

std::vector<Sample> read(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::vector<Sample> lines;
  for (std::string line; std::getline(file, line);) {
    std::istringstream numbers(line);
    lines.emplace_back();
    for (std::string number; numbers >> number;) lines.back().push_back(std::stod(number));
  }
  return lines;
}

TEST(Statistics, EqualSciPyOnRandomCases) {
  const std::vector<Case> cases = random_cases();
  const auto folder =
      std::filesystem::path(testing::TempDir()) / ("salbench_scipy_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  write(cases, folder / "cases");
  const std::string command = "/usr/bin/python3 -W ignore '" SCIPY_REFERENCE "' '" +
                              (folder / "cases").string() + "' '" + (folder / "results").string() + "'";
  const int status = std::system(command.c_str());
  const std::vector<Sample> theirs = read(folder / "results");
  std::filesystem::remove_all(folder);
  ASSERT_EQ(status, 0) << "the reference did not run; it needs the packages python3-scipy and python3-numpy";
  ASSERT_EQ(theirs.size(), cases.size());
  for (std::size_t i = 0; i < cases.size(); ++i) {
    ASSERT_EQ(theirs[i].size(), cases[i].ours.size()) << cases[i].operation << ", case " << i;
    for (std::size_t k = 0; k < theirs[i].size(); ++k)
      EXPECT_NEAR(cases[i].ours[k], theirs[i][k], 1e-9 * std::abs(theirs[i][k]) + 1e-13)
          << cases[i].operation << ", case " << i << ", value " << k;
  }
}

}  // namespace
}  // namespace salbench
