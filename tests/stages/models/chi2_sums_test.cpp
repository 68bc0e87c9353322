// SPDX-License-Identifier: GPL-3.0-or-later
#include <tbb/global_control.h>

#include "stages/core/rng.h"
#include "stages/models/chi2_search.h"
#include "tests/stages/models/random_histograms.h"
#include "tests/support/instructions.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

using chi2_kernel::Weight;

std::vector<double> sums_of(const Chi2Search& search, std::size_t k, Points points, Weight weight) {
  std::vector<float> unknown;
  return weighted_sums(search, k, points, weight, unknown);
}

double weight_by_definition(chi2_kernel::Weight weight, double d) {
  return weight == chi2_kernel::Weight::near ? 1 / (1 + d) : std::log1p(d);
}

// Reference: the terms of the nearest, one after the other.
std::vector<double> twin(const Chi2Search& search, std::size_t k, Points points, Weight weight) {
  std::vector<double> sums(points.size());
  for_each_nearest(search, k, [&](std::size_t i, std::span<const Chi2Neighbour> nearest) {
    for (const auto& [j, chi2] : nearest)
      sums[i] +=
          static_cast<double>(chi2) * weight_by_definition(weight, (points[i] - points[index(j)]).norm());
  });
  return sums;
}

class Chi2SumsVariant : public InstructionsTest {};
INSTANTIATE_TEST_SUITE_P(Chi2, Chi2SumsVariant, every_instruction_set(), name_of_instructions);

TEST_P(Chi2SumsVariant, AreThoseOverTheNearest) {
  const std::vector<Vec3> points = shapes::random_cloud(600, 8);  // in the unit cube
  for (const std::uint64_t levels : {2U, 5U, 1U << 20U}) {
    const Descriptors histograms = random_histograms(600, levels, levels + 1);
    const Chi2Search search(histograms);
    hwy::SetSupportedTargetsForTest(HWY_STATIC_TARGET);
    const Chi2Search baseline(histograms);
    hwy::SetSupportedTargetsForTest(GetParam());
    for (const Weight weight : {Weight::near, Weight::far}) {
      const std::vector<double> sums = sums_of(search, 30, points, weight);
      EXPECT_EQ(sums, sums_of(baseline, 30, points, weight));  // bit for bit
      const std::vector<double> expected = twin(search, 30, points, weight);
      for (std::size_t i = 0; i < sums.size(); ++i)
        EXPECT_NEAR(sums[i], expected[i], 1e-6 * expected[i]) << i;
    }
  }
}

// The last bit does not depend on how the nearest are found: from good or bad guesses, in one range or in
// several at a time.
TEST(Chi2Sums, DependNeitherOnTheGuessesNorOnThreads) {
  const std::vector<Vec3> points = shapes::random_cloud(2500, 8);
  const Chi2Search search(random_histograms(2500, 1U << 20U, 11));
  std::vector<float> kth;
  const std::vector<double> sums = weighted_sums(search, 125, points, Weight::far, kth);
  for_each_nearest(search, 125, [&](std::size_t i, std::span<const Chi2Neighbour> nearest) {
    const float last =
        std::ranges::max_element(nearest, [](const auto& a, const auto& b) { return a.chi2 < b.chi2; })->chi2;
    EXPECT_GE(kth[i], last);
    EXPECT_LE(kth[i], 1.05F * last);
  });
  EXPECT_EQ(weighted_sums(search, 125, points, Weight::far, kth), sums);
  for (std::size_t i = 0; i < kth.size(); ++i) kth[i] *= i % 3 == 0 ? 0 : i % 3 == 1 ? 1e-3F : 1e3F;
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(weighted_sums(search, 125, points, Weight::far, kth), sums);
}

// A power of two is exact: the rounding of terms and the threshold for alike scale as well.
TEST(Chi2Sums, ScaleWithTheHistograms) {
  const std::vector<Vec3> points = shapes::random_cloud(300, 8);
  const Descriptors histograms = random_histograms(300, 1U << 20U, 12);
  const std::vector<double> sums = sums_of(Chi2Search(histograms), 30, points, Weight::near);
  EXPECT_GT(*std::ranges::min_element(sums), 0);
  for (const int power : {-30, -10, 20}) {
    Descriptors scaled = histograms;
    for (float& value : scaled.values) value = std::ldexp(value, power);
    std::vector<double> found = sums_of(Chi2Search(scaled), 30, points, Weight::near);
    for (double& sum : found) sum = std::ldexp(sum, -power);
    EXPECT_EQ(found, sums) << power;
  }
}

// More alike histograms than requested: sums are 0 without measuring all of them, and right for the others.
TEST(Chi2Sums, AreZeroWhereMoreHistogramsAreAlikeThanCount) {
  Descriptors histograms = random_histograms(900, 9, 9);
  for (std::size_t i = 0; i < 600; ++i)
    for (std::size_t bin = 0; bin < kFpfhBins; ++bin)
      histograms.values[i * kFpfhBins + bin] = bin % 11 == 5 ? (i % 3 == 0 ? 100 : 99.99999F) : 0;
  const std::vector<Vec3> points = shapes::random_cloud(900, 3);
  const Chi2Search search(histograms);
  const std::vector<double> sums = sums_of(search, 100, points, Weight::near);
  const std::vector<double> expected = twin(search, 100, points, Weight::near);
  EXPECT_THAT(std::span(sums).first(600), Each(0));
  for (std::size_t i = 0; i < 900; ++i)
    EXPECT_NEAR(sums[i], expected[i], 1e-6 * std::max(expected[i], 1.0)) << i;
}

TEST(Chi2Kernel, WeightsAreExactToSinglePrecision) {
  constexpr float kFine = 0x1p-30F;  // no weight is rounded on this grid
  for (double d = 0; d <= 2; d += 1.0 / 512)
    for (const Weight weight : {Weight::near, Weight::far}) {
      const double expected = weight_by_definition(weight, d);
      EXPECT_NEAR(chi2_kernel::term_of(weight, kFine, 1, static_cast<float>(d)), expected, 3e-7 * expected)
          << d;
    }
}

// Exact in any order of the terms; a double would round most of these sums.
TEST(Chi2Kernel, SumsOfTermsAreExact) {
  Rng rng(3, "terms", "");
  std::vector<double> terms;
  for (int i = 0; i < 4000; ++i)
    terms.push_back(chi2_kernel::term_of(Weight::near, 1.0F / 16,
                                         static_cast<float>(std::exp(20 * rng.uniform() - 12)),
                                         static_cast<float>(rng.uniform())));
  const double as_they_come = std::accumulate(terms.begin(), terms.end(), 0.0);
  std::ranges::sort(terms);
  EXPECT_EQ(std::accumulate(terms.begin(), terms.end(), 0.0), as_they_come);
  EXPECT_EQ(std::accumulate(terms.rbegin(), terms.rend(), 0.0), as_they_come);
}

}  // namespace
}  // namespace salbench
