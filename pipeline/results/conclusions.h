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
  // Those with scores: meshes, scans, clouds, each followed by its splits.
  std::vector<DatasetConclusions> datasets;

  // Names of the columns of a table whose rows begin with DatasetScores::label().
  std::vector<std::string> labelled(std::vector<std::string> columns) const;
  // All splits of a data set together.
  const DatasetConclusions* of(std::string_view dataset) const;  // null if it has no scores
};

// Keeps references to the rows.
Conclusions conclude(const std::vector<ResultRow>& rows, const Metrics& metrics,
                     const StatisticsOptions& options, std::uint64_t seed);

// The tables of these names, whose columns are those of docs/data_dictionary.md. Below: every pair of models
// under every metric, the competitors by rank, their rankings by two metrics, and scores as a share of what
// people reach. [wilcoxon1945] [holm1979]
Table summary_table(const Conclusions& conclusions);
Table significance_table(const Conclusions& conclusions);
Table ranking_table(const Conclusions& conclusions);
Table agreement_table(const Conclusions& conclusions);
Table human_share_table(const Conclusions& conclusions);

// By class. The model "Avg" is the mean over the competitors, unit by unit, so that its interval is one over
// units. Empty where items have no class.
Table per_class_table(const std::vector<ResultRow>& rows, const Metrics& metrics, Observation unit);

// dataset, model, metric, n, mean, ci95_low, ci95_high, rank, group: what a terminal shows of a run.
Table overview_table(const Conclusions& conclusions);

// summary.csv, ranking.csv, ranking_agreement.csv, significance.csv, per_class.csv, human_share.csv,
// compact.csv and leaders.csv, each below `head`. Throws StorageError.
void write_conclusions(const std::filesystem::path& folder, const std::vector<ResultRow>& rows,
                       const Conclusions& conclusions, const std::string& head);

}  // namespace salbench
