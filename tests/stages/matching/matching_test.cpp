// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/matching/matching.h"

#include "stages/core/field.h"
#include "stages/core/rng.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

// Many small values and few large ones, as in saliency maps.
ScalarField skewed_field(std::size_t n, double power, std::uint64_t seed) {
  Rng rng(seed, "field", "");
  ScalarField field(n);
  for (double& value : field) value = std::pow(rng.uniform(), power);
  return field;
}

Histogram uniform_reference() {
  Histogram reference;
  reference.fill(1);
  return reference;
}

TEST(NormalisedHistogram, IsTheDensityOverTheUnitInterval) {
  ScalarField field = {-3, 5, std::nan("")};  // to 0, 1 and 3/8
  const Histogram histogram = normalised_histogram(field);
  EXPECT_NEAR(histogram[0], 100.0 / 3, 1e-9);
  EXPECT_NEAR(histogram[37], 100.0 / 3, 1e-9);
  EXPECT_NEAR(histogram[99], 100.0 / 3, 1e-9);
  EXPECT_NEAR(std::accumulate(histogram.begin(), histogram.end(), 0.0), 100, 1e-9);
}

TEST(NormalisedHistogram, OfAConstantFieldIsOneBinInTheMiddle) {
  for (const double value : {0.0, 7.0, -1e13, 1e308}) {
    const Histogram histogram = normalised_histogram(ScalarField(4, value));
    EXPECT_NEAR(histogram[50], 100, 1e-9) << value;
    EXPECT_NEAR(std::accumulate(histogram.begin(), histogram.end(), 0.0), 100, 1e-9) << value;
  }
}

TEST(MeanHistogram, IsTheMeanOfEachBin) {
  Histogram a{}, b{};
  a[3] = 100;
  b[3] = 40;
  b[99] = 60;
  const Histogram mean = mean_histogram(std::vector{a, b});
  EXPECT_DOUBLE_EQ(mean[3], 70);
  EXPECT_DOUBLE_EQ(mean[99], 30);
  EXPECT_THAT(mean_histogram({}), Each(0.0));
}

TEST(Matched, ToItsOwnHistogramIsTheNormalisedMap) {
  const ScalarField field = skewed_field(5000, 2, 1);
  EXPECT_THAT(matched(field, normalised_histogram(field)),
              Pointwise(DoubleNear(1e-12), min_max_normalised(field)));
}

TEST(Matched, MovesEdgesByTheCumulativeDensities) {
  // A flat map of n = 100 against a reference twice as dense in its lower half: edge x goes to x / 2, except
  // the last, at which the reference's cumulative density finally ends.
  ScalarField field(100);
  for (std::size_t i = 0; i < field.size(); ++i) field[i] = (static_cast<double>(i) + 0.5) / 100;
  field.front() = 0;
  field.back() = 1;
  Histogram reference{};
  std::fill_n(reference.begin(), 50, 2.0);
  const ScalarField result = matched(field, reference);
  EXPECT_EQ(result.front(), 0);
  for (std::size_t i = 1; i + 1 < field.size(); ++i) EXPECT_NEAR(result[i], field[i] / 2, 1e-9) << i;
  EXPECT_EQ(result.back(), 1);
}

TEST(Matched, KeepsTheOrderAndIgnoresScaleAndOffset) {
  ScalarField field = skewed_field(3000, 4, 4), scaled;
  std::ranges::sort(field);
  for (const double value : field) scaled.push_back(1024 * value - 7);
  const Histogram reference = normalised_histogram(skewed_field(3000, 2, 5));
  const ScalarField result = matched(field, reference);
  EXPECT_TRUE(std::ranges::is_sorted(result));
  EXPECT_THAT(matched(scaled, reference), Pointwise(DoubleNear(1e-9), result));
}

TEST(Matched, RefusesInfiniteValues) {
  const ScalarField infinite = {0, 1, -kInfinity};
  EXPECT_THROW(matched(infinite, uniform_reference()), InputError);
  EXPECT_THROW(normalised_histogram(infinite), InputError);
}

TEST(Matched, SpansTheUnitIntervalWhateverTheReference) {
  Histogram one_bin{};
  one_bin[40] = 100;
  for (const Histogram& reference : {uniform_reference(), one_bin}) {
    const ScalarField result = matched(skewed_field(500, 2, 6), reference);
    EXPECT_EQ(*std::ranges::min_element(result), 0);
    EXPECT_EQ(*std::ranges::max_element(result), 1);
  }
}

TEST(Matched, LeavesAConstantMapAsItIs) {
  EXPECT_THAT(matched(ScalarField{5, 5}, uniform_reference()), ElementsAre(5, 5));
  EXPECT_THAT(matched(ScalarField{std::nan(""), std::nan("")}, uniform_reference()), ElementsAre(0, 0));
  EXPECT_TRUE(matched(ScalarField{}, uniform_reference()).empty());
}

TEST(Matched, TakesNanAsZero) {
  EXPECT_EQ(matched(ScalarField{-1, std::nan(""), 3, 2}, uniform_reference()),
            matched(ScalarField{-1, 0, 3, 2}, uniform_reference()));
}

}  // namespace
}  // namespace salbench
