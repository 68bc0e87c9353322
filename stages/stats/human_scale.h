// SPDX-License-Identifier: GPL-3.0-or-later
// Scores of models on the scale of people: how many participants a model is worth, and which share of the way
// from chance to human performance it goes. Both are functions of means over the same units, and their
// intervals come from the same resamples of these.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "stages/stats/resampling.h"

namespace salbench {

// First place where a curve with values at 1, 2, ... and straight lines between them is as good as `level`:
// -infinity where it begins better, infinity where it never is. The curve has one value at least.
double first_reached(std::span<const double> curve, double level, bool higher_is_better);

// Number of times that such a curve passes from one side of `level` to the other.
int crossings(std::span<const double> curve, double level);

struct Equivalent {
  double participants = std::numeric_limits<double>::quiet_NaN();  // first_reached, of the means
  Interval interval = {};                                          // 95 %; its ends may be infinite
  int crossings = 0;                                               // 2 or more: `participants` is the first
};

// One per model. Columns of `scores` (units x columns; one unit at least): the human curve from 1 to `length`
// participants, then the models; `resampled` are their resampled means. [tasse2016]
std::vector<Equivalent> equivalents(const Columns& scores, const Columns& resampled, std::size_t length,
                                    bool higher_is_better);

struct Share {
  double value = std::numeric_limits<double>::quiet_NaN();  // 0: chance, 1: human performance
  Interval interval = {};  // 95 %; an end is infinite where people are too near chance in the resamples
};

// (mean - mean of chance) / (mean of people - mean of chance) of each model. Columns of `scores`: the models,
// then chance, then people, whose means differ. Whether higher or lower is better makes no difference.
std::vector<Share> shares_of_people(const Columns& scores, const Columns& resampled);

}  // namespace salbench
