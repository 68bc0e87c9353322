// SPDX-License-Identifier: GPL-3.0-or-later
// Conclusions from scores: how good each model is, which differ, which is best, and how sure that is. The
// tables are functions of one value, so that they speak of the same units, shapes and resamples.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "io/table.h"
#include "pipeline/results/unit_scores.h"
#include "stages/stats/ranking.h"

namespace salbench {

// The competitors under one metric of one data set.
struct RankedMetric {
  std::size_t metric = 0;  // as chosen
  UnitScores scores;       // no models: none has a score
  Columns resampled;       // resamples x models; none for fewer than two units
  Ranking ranking;         // in the order of scores.models
};

struct DatasetConclusions {
  DatasetScores scores;
  std::vector<RankedMetric> metrics;  // each of the metrics chosen
};

struct Conclusions {
  Metrics metrics;
  Observation unit = Observation::mesh;
  std::shared_ptr<const Bootstrap> bootstrap;  // the resamples of all tables
  std::vector<DatasetConclusions> datasets;    // those with scores: meshes, scans, clouds
};

// Keeps references to the rows.
Conclusions conclude(const std::vector<ResultRow>& rows, const Metrics& metrics,
                     const StatisticsOptions& options, std::uint64_t seed);

// dataset, model, metric, n (units), mean, sd, ci95_low, ci95_high (Student), bca95_low, bca95_high
// (bootstrap over units), n_shapes, n_own_shapes, own_mean: over the shapes that all competitors have a score
// for; the own ones are all that the model has.
Table summary_table(const Conclusions& conclusions);

// dataset, model, metric, n, mean, ci95_low, ci95_high, rank, group: what a terminal shows of a run.
Table overview_table(const Conclusions& conclusions);

// Every pair of models under every metric, as model_a - model_b whether higher or lower values are better: n
// (units), n_shapes, mean_difference, ci95_low, ci95_high, t_p (paired Student: below .05 where the interval
// leaves out 0), ci90_low, ci90_high (within a margin: equivalent by two one-sided tests at .05), d_z,
// rank_biserial, superiority with its interval (probability that a is higher on a new unit), signed_rank,
// signed_rank_p, signed_rank_p_holm (over the n_tests pairs of one data set and metric); and, as the paper
// has them, rank_sum_z and rank_sum_p over all shapes of both, whatever the unit. [wilcoxon1945] [holm1979]
Table significance_table(const Conclusions& conclusions);

// dataset, metric, model, n (units), mean, rank, rank_low, rank_high, first, group: the competitors by rank.
// Two models without a letter of `group` in common differ, all pairs of the metric being compared jointly at
// 0.05; rank_low and rank_high follow from the same comparisons; first is the probability of the best mean
// over resampled units. Empty for fewer than two units.
Table ranking_table(const Conclusions& conclusions);

// dataset, metric_a, metric_b, n, n_models, tau, ci95_low, ci95_high: Kendall's tau-b of the competitors'
// rankings by two metrics over the units that both are defined for, with percentiles over resampled units.
Table agreement_table(const Conclusions& conclusions);

// summary.csv, ranking.csv, ranking_agreement.csv, significance.csv, per_class.csv and human_share.csv, each
// below `head`.
// Throws StorageError.
void write_conclusions(const std::filesystem::path& folder, const std::vector<ResultRow>& rows,
                       const Conclusions& conclusions, const std::string& head);

}  // namespace salbench
