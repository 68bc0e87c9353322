// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/stats/ranking.h"

#include <cmath>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/core/rng.h"

namespace salbench {
namespace {

using testing::ElementsAre;

// Scores of models with these means on units that all models find equally easy or hard.
Columns scores_around(const std::vector<double>& means, std::size_t units, double noise) {
  Rng rng(1, "ranking", "");
  Columns scores{means.size(), {}};
  for (std::size_t u = 0; u < units; ++u) {
    const double unit = rng.normal();
    for (const double mean : means) scores.values.push_back(unit + mean + noise * rng.normal());
  }
  return scores;
}

Ranking ranked(const Columns& scores, bool higher_is_better = true) {
  return rank_models(scores, Bootstrap(1, 2000).means(scores), higher_is_better);
}

TEST(Ranking, ClearDifferencesGiveSingleRanksAndLetters) {
  const Ranking found = ranked(scores_around({0, 2, 1}, 30, 0.1));
  const std::vector<std::int64_t> ranks{3, 1, 2};
  const std::vector<std::string> letters{"c", "a", "b"};
  for (std::size_t m = 0; m < 3; ++m) {
    EXPECT_EQ(found.models[m].rank, ranks[m]);
    EXPECT_EQ(found.models[m].rank_low, ranks[m]);
    EXPECT_EQ(found.models[m].rank_high, ranks[m]);
    EXPECT_EQ(found.models[m].letters, letters[m]);
    EXPECT_EQ(found.models[m].first, m == 1 ? 1 : 0);
  }
}

TEST(Ranking, LowerIsBetterTurnsItRound) {
  const Ranking found = ranked(scores_around({0, 2, 1}, 30, 0.1), false);
  EXPECT_EQ(found.models[0].rank, 1);
  EXPECT_EQ(found.models[1].rank_low, 3);
  EXPECT_EQ(found.models[0].letters, "a");
  EXPECT_EQ(found.models[0].first, 1);
}

TEST(Ranking, ModelsThatCannotBeToldApartShareALetterAndTheirRanks) {
  const Ranking found = ranked(scores_around({1, 1, 0}, 30, 0.3));
  for (const std::size_t m : {0, 1}) {
    EXPECT_EQ(found.models[m].rank_low, 1);
    EXPECT_EQ(found.models[m].rank_high, 2);
    EXPECT_EQ(found.models[m].letters, "a");
  }
  EXPECT_EQ(found.models[2].letters, "b");
  EXPECT_NEAR(found.models[0].first + found.models[1].first, 1, 1e-12);
}

TEST(Ranking, CopiesOfAModelShareRankAndFirstPlace) {
  Columns scores = scores_around({0, 0}, 20, 0.2);
  for (std::size_t u = 0; u < scores.units(); ++u) scores.values[2 * u + 1] = scores.values[2 * u];
  for (const ModelRank& model : ranked(scores).models) {
    EXPECT_EQ(model.rank, 1);
    EXPECT_EQ(model.first, 0.5);
    EXPECT_EQ(model.letters, "a");
  }
}

TEST(Ranking, OneUnitRanksWithoutSayingHowSure) {
  const Ranking found = ranked({2, {0.3, 0.4}});
  EXPECT_EQ(found.models[1].rank, 1);
  EXPECT_EQ(found.models[1].rank_high, 0);
  EXPECT_EQ(found.models[1].letters, "");
  EXPECT_TRUE(std::isnan(found.models[1].first));
}

// The bound of a single pair is Student's.
TEST(Ranking, OfTwoModelsIsBoundByStudentsQuantile) {
  EXPECT_NEAR(ranked(scores_around({0, 0}, 25, 1)).critical, 2.0639, 0.1);
}

TEST(CompactLetters, AChainOverlaps) {
  // Neighbours do not differ, others do.
  std::vector<std::vector<bool>> differ(4, std::vector<bool>(4));
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j) differ[i][j] = i > j + 1 || j > i + 1;
  EXPECT_THAT(compact_letters(differ, std::vector<std::size_t>{0, 1, 2, 3}),
              ElementsAre("a", "ab", "bc", "c"));
}

// What a display promises, over random relations: two items share a letter exactly where they do not differ.
TEST(CompactLetters, ShareALetterExactlyWhereItemsDoNotDiffer) {
  Rng rng(1, "letters", "");
  for (int round = 0; round < 200; ++round) {
    const std::size_t n = 1 + rng.below(8);
    std::vector<std::vector<bool>> differ(n, std::vector<bool>(n));
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < i; ++j) differ[i][j] = differ[j][i] = rng.below(2) == 0;
    std::vector<std::size_t> order(n);
    std::iota(order.begin(), order.end(), std::size_t{0});
    const std::vector<std::string> letters = compact_letters(differ, order);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < i; ++j)
        EXPECT_EQ(letters[i].find_first_of(letters[j]) == std::string::npos, differ[i][j]);
  }
}

TEST(KendallTau, OfSmallLists) {
  const std::vector<double> x{1, 2, 3, 4};
  EXPECT_EQ(kendall_tau(x, x), 1);
  EXPECT_EQ(kendall_tau(x, std::vector<double>{4, 3, 2, 1}), -1);
  EXPECT_NEAR(kendall_tau(x, std::vector<double>{2, 1, 4, 3}), 1.0 / 3, 1e-15);
  EXPECT_TRUE(std::isnan(kendall_tau(x, std::vector<double>(4, 1.0))));
}

}  // namespace
}  // namespace salbench
