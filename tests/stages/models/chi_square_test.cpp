// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/chi_square.h"

#include "stages/core/rng.h"
#include "tests/support/instructions.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

TEST(ChiSquare, IsNotHalvedAndSkipsEmptyBins) {
  std::array<float, kFpfhBins> a{}, b{};
  a[3] = 1, b[3] = 3, b[32] = 5;
  EXPECT_DOUBLE_EQ(chi_square(a, b), 4.0 / 4 + 5);
  EXPECT_DOUBLE_EQ(chi_square(b, a), 6);
  EXPECT_EQ(chi_square(a, a), 0);
}

// Bin by bin, by the formula.
double by_definition(std::span<const float, kFpfhBins> a, std::span<const float, kFpfhBins> b) {
  double result = 0;
  for (std::size_t bin = 0; bin < kFpfhBins; ++bin) {
    const float sum = a[bin] + b[bin], difference = a[bin] - b[bin];
    if (sum > 0) result += static_cast<double>(difference * difference / sum);
  }
  return result;
}

// Magnitudes from tiny to large; every fourth bin is 0 in all, and a third of the others.
Descriptors scattered_descriptors(std::size_t n) {
  Rng rng(5, "chi_square", "");
  Descriptors descriptors;
  for (std::size_t i = 0; i < n * kFpfhBins; ++i) {
    const double magnitude = std::pow(10.0, 40 * rng.uniform() - 25);
    const bool empty = i % kFpfhBins % 4 == 1 || rng.uniform() < 0.3;
    descriptors.values.push_back(empty ? 0.0F : static_cast<float>(magnitude * rng.uniform()));
  }
  return descriptors;
}

TEST(ChiSquares, LookAtTheBinsInUse) {
  const auto bins = used_bins(scattered_descriptors(40));
  EXPECT_EQ(bins.size(), kFpfhBins - 8);
  EXPECT_EQ(bins[1], 2U);
}

class ChiSquaresVariant : public InstructionsTest {};
INSTANTIATE_TEST_SUITE_P(ChiSquare, ChiSquaresVariant, every_instruction_set(), name_of_instructions);

TEST_P(ChiSquaresVariant, AreToTheBitThoseOfTheFormulaHoweverManyThereAre) {
  const Descriptors descriptors = scattered_descriptors(40);
  for (std::size_t count = 0; count <= 20; ++count) {
    std::vector<std::int32_t> rows;
    for (std::size_t i = 0; i < count; ++i) rows.push_back(static_cast<std::int32_t>((7 * i + count) % 40));
    std::vector<double> result(count);
    ChiSquares chi_squares(used_bins(descriptors));
    chi_squares.set_rows(descriptors, rows);
    chi_squares.measure(descriptors.row(count), result);
    for (std::size_t i = 0; i < count; ++i) {
      const auto other = descriptors.row(index(rows[i]));
      EXPECT_EQ(result[i], by_definition(descriptors.row(count), other));
      EXPECT_EQ(result[i], chi_square(descriptors.row(count), other));
    }
  }
}

}  // namespace
}  // namespace salbench
