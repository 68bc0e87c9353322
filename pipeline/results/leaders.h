// SPDX-License-Identifier: GPL-3.0-or-later
// Who leads, and how sure that is: what the ranks of a metric allow to say of the first, and a sentence per
// data set. References are no candidates.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/results/conclusions.h"

namespace salbench {

// Of the joint intervals of the ranks under one metric.
enum class Lead {
  leads,       // one model has the rank 1 to 1: it is ahead of every other one
  not_behind,  // one model's interval alone reaches 1, but it is not ahead of all others
  not_apart,   // intervals of several models reach 1
  only_model,
  one_unit,  // ranks have no intervals
  no_shape   // that all competitors have a score for
};
template <>
struct EnumNames<Lead> {
  static constexpr std::array<std::string_view, 6> names{"leads",      "not behind", "not told apart",
                                                         "only model", "one unit",   "no common shape"};
};

// The competitors at the top by one metric.
struct Leader {
  const Metric* metric = nullptr;
  Lead verdict = Lead::one_unit;
  std::vector<std::string> models = {};  // whose rank may be the first, best mean first; all for one unit
  std::vector<std::string> near = {};    // not_behind: those that it cannot be told apart from
  std::size_t n_models = 0;
  double mean = std::numeric_limits<double>::quiet_NaN();  // of the best model
  Interval interval = {};                                  // of it, 95 %, within the range of the metric
  std::string second = {};                                 // model with the next best mean; empty: none
  // How far the best mean is ahead of that, positive whether higher or lower is better, and its 95 %
  // interval, joint for all pairs of models: above 0 where the pair differs.
  double lead = std::numeric_limits<double>::quiet_NaN();
  Interval lead_interval = {};
  std::int64_t n = 0, n_shapes = 0;  // units and shapes
};

struct LevelLeaders {
  std::string dataset = {}, split = {};  // empty split: all of them
  std::vector<Leader> metrics = {};      // those with competitors, in the order of the metrics chosen
  std::string sentence = {};             // of the leading metrics; says no more than the intervals allow
};

// Names of the metrics that sentences speak of: the paper's, filled up to three with the first of the others.
std::vector<std::string> leading_metrics(const Metrics& metrics);

// One per data set and split of the conclusions. Keeps references to their metrics.
std::vector<LevelLeaders> find_leaders(const Conclusions& conclusions);

// leaders.csv (docs/data_dictionary.md).
Table leaders_table(const Conclusions& conclusions, const std::vector<LevelLeaders>& leaders);

// The sentences, a line each.
std::string leading_text(const std::vector<LevelLeaders>& leaders);

}  // namespace salbench
