// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/chi2_search.h"

#include "stages/core/rng.h"
#include "tests/stages/models/random_histograms.h"
#include "tests/support/instructions.h"
#include "tests/support/shapes.h"
#include "tests/support/test.h"

namespace salbench {
namespace {

// Histograms with a single nonzero bin: distances |a - b|^2 / (a + b).
Descriptors one_bin(const std::vector<float>& heights) {
  Descriptors descriptors;
  descriptors.values.resize(heights.size() * kFpfhBins);
  for (std::size_t i = 0; i < heights.size(); ++i) descriptors.values[i * kFpfhBins + 7] = heights[i];
  return descriptors;
}

std::vector<Chi2Neighbour> by_index(std::span<const Chi2Neighbour> nearest) {
  std::vector<Chi2Neighbour> sorted(nearest.begin(), nearest.end());
  std::ranges::sort(sorted, [](const Chi2Neighbour& a, const Chi2Neighbour& b) { return a.index < b.index; });
  return sorted;
}

std::vector<std::vector<std::int32_t>> indices_of(const Chi2Search& search, std::size_t k) {
  std::vector<std::vector<std::int32_t>> result(search.size());
  for_each_nearest(search, k, [&](std::size_t i, std::span<const Chi2Neighbour> nearest) {
    EXPECT_THAT(result[i], IsEmpty());
    for (const Chi2Neighbour& neighbour : by_index(nearest)) result[i].push_back(neighbour.index);
  });
  return result;
}

bool nearer(const Chi2Neighbour& a, const Chi2Neighbour& b) {
  return std::pair(a.chi2, b.index) < std::pair(b.chi2, a.index);
}

// Brute-force reference: for each histogram a full sort of all, ties by descending index.
using Ranking = std::vector<std::vector<Chi2Neighbour>>;
Ranking ranking_of(const Descriptors& descriptors) {
  Ranking ranking(descriptors.size());
  for (std::size_t i = 0; i < descriptors.size(); ++i) {
    for (std::size_t j = 0; j < descriptors.size(); ++j)
      ranking[i].push_back(
          {static_cast<std::int32_t>(j), chi2_by_formula(descriptors.row(i), descriptors.row(j))});
    std::sort(ranking[i].begin(), ranking[i].end(), nearer);
  }
  return ranking;
}

void expect_first_of(const Ranking& ranking, std::size_t k, const Chi2Search& search) {
  std::size_t rows = 0;
  for_each_nearest(search, k, [&](std::size_t i, std::span<const Chi2Neighbour> unordered) {
    ++rows;
    std::vector<Chi2Neighbour> nearest(unordered.begin(), unordered.end());
    std::ranges::sort(nearest, nearer);
    ASSERT_EQ(nearest.size(), k);
    for (std::size_t c = 0; c < k; ++c) {
      ASSERT_EQ(nearest[c].index, ranking[i][c].index) << "row " << i << " of " << ranking.size();
      ASSERT_EQ(nearest[c].chi2, ranking[i][c].chi2) << "row " << i << ", to the last bit";
    }
  });
  EXPECT_EQ(rows, ranking.size());
}

class Chi2SearchVariant : public InstructionsTest {
 protected:
  static void expect_equals_brute_force(const Descriptors& descriptors,
                                        std::initializer_list<std::size_t> counts) {
    const Ranking ranking = ranking_of(descriptors);
    const Chi2Search search(descriptors);
    for (const std::size_t k : counts) expect_first_of(ranking, k, search);
  }
};
INSTANTIATE_TEST_SUITE_P(Chi2, Chi2SearchVariant, every_instruction_set(), name_of_instructions);

TEST_P(Chi2SearchVariant, EqualsBruteForce) {
  for (const std::size_t n : {1U, 15U, 16U, 17U, 130U})  // no distances are equal
    expect_equals_brute_force(random_histograms(n, 1U << 20U, n), {1, (n + 4) / 5, n});
  for (const std::size_t k : {1U, 7U, 40U, 99U}) expect_equals_brute_force(random_histograms(100, 2, k), {k});
  for (const std::uint64_t levels : {2U, 5U, 1U << 20U})  // several levels of boxes
    expect_equals_brute_force(random_histograms(600, levels, levels), {1, 30, 570});
}

// Histograms of a few kinds, as on real shapes: the search skips distant boxes.
TEST_P(Chi2SearchVariant, EqualsBruteForceWhereMostIsPassedOver) {
  Rng rng(5, "kinds", "");
  const Descriptors kinds = random_histograms(12, 100, 6);
  Descriptors histograms;
  for (std::size_t i = 0; i < 1500; ++i)
    for (const float value : kinds.row(rng.below(12)))
      histograms.values.push_back(value + static_cast<float>(rng.below(4)));
  expect_equals_brute_force(histograms, {1, 75, 300});
}

TEST(Chi2Search, ComparesWithTheReferencesAlone) {
  const Descriptors histograms = random_histograms(700, 9, 8);
  std::vector<std::int32_t> references;
  for (std::int32_t i = 5; i < 700; i += 3) references.push_back(i);
  const Chi2Search search(histograms, references);
  std::size_t rows = 0;
  for_each_nearest(search, 20, [&](std::size_t i, std::span<const Chi2Neighbour> unordered) {
    ++rows;
    std::vector<std::pair<float, std::int32_t>> all;  // among equal distances, the higher index first
    for (const std::int32_t j : references)
      all.emplace_back(chi2_by_formula(histograms.row(i), histograms.row(index(j))), -j);
    std::ranges::sort(all);
    std::vector<std::int32_t> expected, found;
    for (std::size_t c = 0; c < 20; ++c) expected.push_back(-all[c].second);
    std::ranges::sort(expected);
    for (const Chi2Neighbour& neighbour : by_index(unordered)) found.push_back(neighbour.index);
    ASSERT_EQ(found, expected) << "row " << i;
  });
  EXPECT_EQ(rows, 700U);
}

TEST_P(Chi2SearchVariant, RecoversFromAGuessThatMisleads) {
  // Neighbours in the order of the search have very different k-th distances.
  std::vector<float> heights(2048);
  for (std::size_t i = 0; i < heights.size(); ++i)
    heights[i] = i % 8 == 0 ? 1 : std::pow(1.04F, static_cast<float>(i % 1024));
  expect_equals_brute_force(one_bin(heights), {3, 200, 614});
}

TEST(Chi2Search, OfEqualDistancesAtTheBoundaryTheHigherIndexStays) {
  const Chi2Search search(one_bin({1, 4, 1, 4, 4}));
  EXPECT_THAT(indices_of(search, 1),
              ElementsAre(ElementsAre(2), ElementsAre(4), ElementsAre(2), ElementsAre(4), ElementsAre(4)));
  EXPECT_THAT(indices_of(search, 4)[0], ElementsAre(0, 2, 3, 4));
  EXPECT_THAT(indices_of(search, 4)[1], ElementsAre(1, 2, 3, 4));
}

TEST(Chi2Search, LeavesOutOnlyBinsThatAreNeverFilledAndKeepsOne) {
  EXPECT_EQ(Chi2Search(one_bin({0, 0, 3})).bins().size(), 1U);
  EXPECT_EQ(Chi2Search(random_histograms(50, 9, 1)).bins().size(), 33U);
  const Chi2Search empty(one_bin({0, 0, 0}));
  EXPECT_EQ(empty.bins().size(), 1U);
  EXPECT_THAT(indices_of(empty, 2)[0], ElementsAre(1, 2));
}

TEST(Chi2Search, NamesThePointOfADescriptorThatIsNoHistogram) {
  for (const float wrong :
       {-1.F, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()})
    EXPECT_THAT([&] { Chi2Search(one_bin({1, 2, wrong})); }, Refuses("descriptor of point 2"));
}

float term_of_bin(float a, float b) { return (b - a) * (b - a) / (b + a + 1e-18F); }

TEST_P(Chi2SearchVariant, BoundsHaveTheBytesOfTheFormula) {
  constexpr std::size_t bins = 17;
  const std::vector<std::int32_t> groups = {4, 0, 3};
  Rng rng(3, "kernel", "");
  std::vector<float> boxes(5 * bins * 2 * chi2_kernel::kLanes), query(bins);
  for (float& value : boxes) value = rng.below(3) == 0 ? 0 : static_cast<float>(100 * rng.uniform());
  for (float& value : query) value = rng.below(3) == 0 ? 0 : static_cast<float>(100 * rng.uniform());
  const std::size_t count = groups.size() * chi2_kernel::kLanes;
  std::vector<float> bounds(count), expected;
  for (const std::int32_t group : groups)
    for (std::size_t lane = 0; lane < chi2_kernel::kLanes; ++lane) {
      float bound = 0;
      for (std::size_t bin = 0; bin < bins; ++bin) {
        const float* const least = &boxes[(index(group) * bins + bin) * 2 * chi2_kernel::kLanes + lane];
        bound +=
            term_of_bin(query[bin], std::min(std::max(query[bin], least[0]), least[chi2_kernel::kLanes]));
      }
      expected.push_back(bound);
    }
  const chi2_kernel::Kernel& kernel = chi2_kernel::kernel();
  kernel.bounds(boxes.data(), bins, query.data(), groups.data(), groups.size(), bounds.data());
  EXPECT_GT(*std::ranges::min_element(bounds), 0);
  EXPECT_EQ(bounds, expected);
}

TEST_P(Chi2SearchVariant, PlacesAndCountTakeTheLimitAndPassOverInfinityAndNaN) {
  std::vector<float> values(48, std::numeric_limits<float>::infinity());
  values[0] = values[15] = values[16] = values[47] = 2;
  values[20] = 2.5F;
  values[21] = std::numeric_limits<float>::quiet_NaN();
  std::vector<std::int32_t> places(48, -1);
  const chi2_kernel::Kernel& kernel = chi2_kernel::kernel();
  EXPECT_EQ(kernel.count_up_to(2, values.data(), values.size()), 4U);
  ASSERT_EQ(kernel.places_between(1, 2, values.data(), values.size(), places.data()), 4U);
  EXPECT_THAT(std::vector(places.begin(), places.begin() + 4), ElementsAre(0, 15, 16, 47));
  EXPECT_EQ(kernel.places_between(2, 2.5F, values.data(), values.size(), places.data()), 1U);
}

}  // namespace
}  // namespace salbench
