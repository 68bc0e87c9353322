// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/core/field.h"

#include "stages/core/rng.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

TEST(Errors, AreWholeWhateverTheyRepeat) {
  const std::string said("a\0b\0", 4);
  EXPECT_STREQ(InputError(said).what(), "a\\0b\\0");
  EXPECT_STREQ(FileError(said, said).what(), "a\\0b\\0: a\\0b\\0");
  EXPECT_STREQ(ConfigError(said).what(), "a\\0b\\0");
  EXPECT_STREQ(StorageError(said).what(), "a\\0b\\0");
  EXPECT_STREQ(OptionError("key", said).what(), "key a\\0b\\0");
}

TEST(MinMaxNormalised, SpansTheUnitIntervalAndTakesNanAsZero) {
  EXPECT_THAT(min_max_normalised(std::vector<double>{-1, std::nan(""), 3}), ElementsAre(0, 0.25, 1));
}

TEST(MinMaxNormalised, LeavesAConstantFieldAsItIs) {
  EXPECT_THAT(min_max_normalised(std::vector<double>{5, 5, 5}), ElementsAre(5, 5, 5));
  EXPECT_TRUE(min_max_normalised(std::vector<double>{}).empty());
}

TEST(MinMaxNormalised, IsThatOfAnyMultiple) {
  Rng rng(2, "field", "");
  std::vector<double> field(500);
  for (double& v : field) v = 4 * rng.uniform() - 2;
  const ScalarField expected = min_max_normalised(field);
  for (const int power : {-900, 400, 700}) {
    std::vector<double> multiple = field;
    for (double& v : multiple) v = std::ldexp(v, power);
    EXPECT_EQ(min_max_normalised(multiple), expected) << power;
  }
}

TEST(MinMaxNormalised, RefusesInfiniteValues) {
  for (const double infinite : {kInfinity, -kInfinity})
    for (const std::vector<double>& field :
         {std::vector<double>{0, infinite, 1}, {infinite, infinite}, {std::nan(""), infinite}})
      EXPECT_THAT([&] { min_max_normalised(field); }, Refuses("inf, expected a finite number"));
  EXPECT_THROW(min_max_normalised(std::vector<double>{-kInfinity, kInfinity}), InputError);
}

TEST(RequireFinite, NamesTheFirstValueThatIsNot) {
  EXPECT_NO_THROW(require_finite({}, "the map"));
  EXPECT_NO_THROW(require_finite(std::vector<double>{1, std::nan("")}, "the map", true));
  EXPECT_THAT(
      [] {
        require_finite(std::vector<double>{0, 1, std::nan(""), kInfinity}, "the map");
      },
      ThrowsMessage<InputError>("the map: value 2 (0-based) is nan, expected a finite number"));
  EXPECT_THAT(
      [] {
        require_finite(std::vector<double>{0, std::nan(""), kInfinity}, "the map", true);
      },
      ThrowsMessage<InputError>("the map: value 2 (0-based) is inf, expected a finite number, or NaN"));
}

TEST(RequireFinite, RefusesAMapWhoseLargestMagnitudeIsNotOrdinary) {
  for (const std::vector<double>& ordinary :
       {std::vector<double>{0, -0.0}, {5e-324, 1e-100}, {-1e100, 1}, {1, 1e-300}})
    EXPECT_NO_THROW(require_finite(ordinary, "the map"));
  EXPECT_THAT(
      [] {
        require_finite(std::vector<double>{1, -1e200, 3}, "the map");
      },
      ThrowsMessage<InputError>(
          "the map: value 1 (0-based) is -1e+200, the largest magnitude, expected 1e-100 to "
          "1e+100: rescale all values"));
  EXPECT_THAT(
      [] {
        require_finite(std::vector<double>{0, std::nan(""), 1e-120}, "the map", true);
      },
      Refuses("value 2 (0-based) is 1e-120"));
}

TEST(RequireFinite, NamesThePointWithACoordinateThatIsTooLarge) {
  EXPECT_NO_THROW(require_finite(std::vector<Vec3>{{1e50, 0, 1e-300}}));
  EXPECT_THAT(
      [] {
        require_finite(std::vector<Vec3>{{0, 0, 0}, {0, -2e50, 0}});
      },
      ThrowsMessage<InputError>(
          "point 1 (0-based) has a coordinate of 2e+50, expected at most 1e+50: scale the shape"));
  EXPECT_THAT(
      [] {
        require_finite(std::vector<Vec3>{{0, kInfinity, 0}});
      },
      ThrowsMessage<InputError>("point 0 (0-based) has a coordinate that is not finite"));
}

TEST(BinnedDensity, IntegratesToOneOverItsEdges) {
  Rng rng(1, "field", "");
  std::vector<double> field(3000);
  for (double& v : field) v = -2 + 7 * rng.uniform() * rng.uniform();
  const BinnedDensity h = binned_density(field);
  double integral = 0;
  for (std::size_t i = 0; i < kHistogramBins; ++i) integral += h.density[i] * (h.edges[i + 1] - h.edges[i]);
  EXPECT_NEAR(integral, 1, 1e-12);
}

TEST(BinnedDensity, EdgesBelongToTheRightAndTheLastToTheLeft) {
  std::vector<double> field(101);
  std::iota(field.begin(), field.end(), 0.0);
  const BinnedDensity h = binned_density(field);
  for (std::size_t i = 0; i + 1 < kHistogramBins; ++i) EXPECT_NEAR(h.density[i], 1 / 101.0, 1e-12) << i;
  EXPECT_NEAR(h.density.back(), 2 / 101.0, 1e-12);
}

TEST(BinnedDensity, ConstantFieldFallsInTheMiddle) {
  const BinnedDensity h = binned_density(std::vector<double>{3, 3, 3});
  EXPECT_DOUBLE_EQ(h.edges.front(), 2.5);
  EXPECT_NEAR(h.density[50], 100, 1e-9);
}

// Half a unit beside a large value is rounded to the value, which leaves no bins.
TEST(BinnedDensity, AConstantFieldFallsInTheMiddleHoweverLargeItIs) {
  for (const double value : {1e5, -1e7, 1e13, 1e17, -1e300, std::numeric_limits<double>::max()}) {
    const BinnedDensity h = binned_density(std::vector<double>{value, value});
    for (std::size_t i = 0; i < kHistogramBins; ++i)
      EXPECT_NEAR(h.density[i], i == 50 ? 100 : 0, 1e-6) << value;
  }
}

TEST(BinnedDensity, RefusesWhatHasNoRange) {
  for (const std::vector<double>& field : {std::vector<double>{-1.7e308, 1.7e308},
                                           {0, kInfinity},
                                           {std::nan("")},
                                           {0, std::nan(""), 1},
                                           {0, 1, std::nan("")}})
    EXPECT_THROW(binned_density(field), std::logic_error);
}

TEST(PickedPoints, AreDistinctAndAscending) {
  GroundTruth truth;
  truth.picks = {{9, 2, 2}, {}, {2, 5}};
  EXPECT_THAT(picked_points(truth), ElementsAre(2, 5, 9));
}

}  // namespace
}  // namespace salbench
