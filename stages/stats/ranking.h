// SPDX-License-Identifier: GPL-3.0-or-later
// Ranks of models, and how sure they are. All pairs of models are compared at once: the intervals of their
// mean differences hold together with 95 % probability (the largest of the standardised differences over
// the resamples is what bounds them), so that no pair stands out by its number alone. Ranks and groups follow
// from these intervals: a model's rank lies between 1 + the models above it and k - the models below it.
// [romano2005] [mogstad2024] [piepho2004]
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "stages/stats/resampling.h"

namespace salbench {

struct ModelRank {
  double mean = std::numeric_limits<double>::quiet_NaN();
  std::int64_t rank = 0;                                    // 1: best; equal means share the best rank
  std::int64_t rank_low = 0, rank_high = 0;                 // 95 %, jointly; 0 for fewer than two units
  double first = std::numeric_limits<double>::quiet_NaN();  // share of the resamples where it is best
  std::string letters;  // two models without a letter in common differ; empty for fewer than two units
};

struct Ranking {
  std::vector<ModelRank> models;                               // in the order of the columns
  double critical = std::numeric_limits<double>::quiet_NaN();  // standard errors that bound every pair
};

// Ranks the columns of `scores` (units x models) with their resampled means, which are not read for fewer
// than two units.
Ranking rank_models(const Columns& scores, const Columns& resampled, bool higher_is_better);

// Kendall's tau-b of two lists of values of the same models; NaN where one of them is constant.
// [kendall1945]
double kendall_tau(std::span<const double> x, std::span<const double> y);

// A letter for each largest group of items of which no two differ; items in the order of the letters.
// differ(i, j) is symmetric. The order of the items decides which group is "a". [piepho2004]
std::vector<std::string> compact_letters(const std::vector<std::vector<bool>>& differ,
                                         std::span<const std::size_t> order);

}  // namespace salbench
