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

// The map; the value that is named, if it is refused; whether NaN may be there.
TEST(RequireFinite, NamesTheFirstValueThatIsNotFiniteOrTheLargestIfItIsNotOrdinary) {
  const struct {
    std::vector<double> map;
    const char* named;
    bool may_be_nan = false;
  } rows[] = {{{}, nullptr},
              {{1, kNan}, nullptr, true},
              {{0, -0.0}, nullptr},
              {{5e-324, 1e-100}, nullptr},
              {{-1e100, 1}, nullptr},
              {{1, 1e-300}, nullptr},
              {{0, 1, kNan, kInfinity}, "the map: value 2 (0-based) is nan"},
              {{0, kNan, kInfinity}, "the map: value 2 (0-based) is inf", true},
              {{1, -1e200, 3}, "the map: value 1 (0-based) is -1e+200"},
              {{0, kNan, 1e-120}, "value 2 (0-based) is 1e-120", true}};
  for (const auto& [map, named, may_be_nan] : rows) {
    const auto required = [&map = map, nan = may_be_nan] { require_finite(map, "the map", nan); };
    if (named == nullptr)
      EXPECT_NO_THROW(required());
    else
      EXPECT_THAT(required, Refuses(named));
  }
}

TEST(RequireFinite, NamesThePointWithACoordinateThatIsTooLarge) {
  const auto required = [](const Vec3& second) {
    return [=] { require_finite(std::vector{Vec3(1e50, 0, 1e-300), second}); };
  };
  EXPECT_NO_THROW(required({0, 0, 0})());
  for (const double bad : {-2e50, kInfinity, kNan})
    EXPECT_THAT(required({0, bad, 0}), Refuses("point 1 (0-based)"));
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

// Half a unit beside a large value is rounded to the value, which leaves no bins.
TEST(BinnedDensity, AConstantFieldFallsInTheMiddleHoweverLargeItIs) {
  EXPECT_DOUBLE_EQ(binned_density(std::vector<double>{3, 3, 3}).edges.front(), 2.5);
  for (const double value : {3.0, 1e5, -1e7, 1e13, 1e17, -1e300, std::numeric_limits<double>::max()}) {
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
