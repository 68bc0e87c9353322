// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/results/conclusions.h"

#include <algorithm>
#include <numeric>

#include "io/file.h"
#include "pipeline/results/compact.h"
#include "pipeline/results/leaders.h"
#include "pipeline/results/raw_tables.h"
#include "pipeline/results/table_rows.h"
#include "stages/stats/summary.h"

namespace salbench {
namespace {

// Resampled means of a model's scores: those of the ranking where it is ranked, else by the same draws.
Interval bca_of(const UnitScores& own, std::size_t model, const RankedMetric& ranked,
                const Bootstrap& bootstrap) {
  if (own.units.size() < 2) return {};
  const std::size_t place = ranked.scores.column_of(model);
  return bca_interval(own.scores.values, place < ranked.scores.models.size()
                                             ? ranked.resampled.column(place)
                                             : bootstrap.means(own.scores).values);
}

std::vector<Cell> summary_row(const DatasetScores& scores, std::size_t model, const RankedMetric& ranked,
                              const std::string& metric, const Bootstrap& bootstrap) {
  const UnitScores compared = scores.compared(ranked.metric, {&model, 1});
  const UnitScores own = scores.own(ranked.metric, model);
  const Summary summary = summarise(compared.scores.values);
  return cells(scores.label(), scores.models()[model], metric, summary.n, summary.mean, summary.sd,
               student_interval(summary), bca_of(compared, model, ranked, bootstrap), compared.n_shapes,
               own.n_shapes, summarise(own.scores.values).mean);
}

// A rank that is not known is an empty cell.
Cell rank_cell(std::int64_t rank) { return rank > 0 ? Cell(rank) : Cell(std::string()); }

Rows ranking_rows(const DatasetScores& scores, const RankedMetric& ranked, const Metric& metric) {
  std::vector<std::size_t> order(ranked.ranking.models.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t m) { return ranked.ranking.models[m].rank; });
  Rows rows;
  for (const std::size_t m : order) {
    const ModelRank& model = ranked.ranking.models[m];
    rows.push_back(cells(scores.label(), metric.name, scores.models()[ranked.scores.models[m]],
                         ranked.scores.units.size(), ranked.scores.n_shapes, model.mean,
                         rank_cell(model.rank), rank_cell(model.rank_low), rank_cell(model.rank_high),
                         model.first, model.letters));
  }
  return rows;
}

}  // namespace

Conclusions conclude(const std::vector<ResultRow>& rows, const Metrics& metrics,
                     const StatisticsOptions& options, std::uint64_t seed) {
  Conclusions conclusions{metrics, options.unit, std::make_shared<Bootstrap>(seed), {}};
  std::vector<std::pair<std::string_view, std::string>> parts;  // data set and split
  for (const std::string_view dataset : kShapeNames) {
    parts.emplace_back(dataset, "");
    for (const std::string& split : splits_among(rows, dataset)) parts.emplace_back(dataset, split);
  }
  for (const auto& [dataset, split] : parts) {
    DatasetScores scores(rows, dataset, options.unit, {}, split);
    if (scores.models().empty()) continue;
    std::vector<RankedMetric> ranked(metrics.size());
    for (std::size_t m = 0; m < metrics.size(); ++m) {
      ranked[m].metric = m;
      ranked[m].scores = scores.compared(m, scores.competitors(m));
      if (ranked[m].scores.units.size() >= 2)
        ranked[m].resampled = conclusions.bootstrap->means(ranked[m].scores.scores);
    }
    parallel_ranges(metrics.size(), 1, [&](std::size_t m, std::size_t) {
      ranked[m].ranking =
          rank_models(ranked[m].scores.scores, ranked[m].resampled, metrics[m].higher_is_better);
    });
    conclusions.datasets.push_back({std::move(scores), std::move(ranked)});
  }
  return conclusions;
}

std::vector<std::string> Conclusions::labelled(std::vector<std::string> columns) const {
  if (!datasets.empty() && datasets[0].scores.in_splits()) columns.insert(columns.begin() + 1, "split");
  return columns;
}

const DatasetConclusions* Conclusions::of(std::string_view dataset) const {
  const auto found =
      std::ranges::find(datasets, dataset, [](const auto& one) { return one.scores.dataset(); });
  return found == datasets.end() ? nullptr : &*found;
}

Table summary_table(const Conclusions& conclusions) {
  Table table{.columns = conclusions.labelled({"dataset", "model", "metric", "n", "mean", "sd", "ci95_low",
                                               "ci95_high", "bca95_low", "bca95_high", "n_shapes",
                                               "n_own_shapes", "own_mean"}),
              .rows = {}};
  for (const auto& [scores, metrics] : conclusions.datasets) {
    const Rows rows = rows_of_each(scores.models().size() * metrics.size(), [&](std::size_t row) {
      const RankedMetric& ranked = metrics[row % metrics.size()];
      return Rows{summary_row(scores, row / metrics.size(), ranked, conclusions.metrics[ranked.metric].name,
                              *conclusions.bootstrap)};
    });
    table.rows.insert(table.rows.end(), rows.begin(), rows.end());
  }
  return table;
}

Table overview_table(const Conclusions& conclusions) {
  Table table{.columns = conclusions.labelled(
                  {"dataset", "model", "metric", "n", "mean", "ci95_low", "ci95_high", "rank", "group"}),
              .rows = {}};
  for (const auto& [scores, metrics] : conclusions.datasets)
    for (std::size_t model = 0; model < scores.models().size(); ++model)
      for (const RankedMetric& ranked : metrics) {
        const Summary summary = summarise(scores.compared(ranked.metric, {&model, 1}).scores.values);
        const std::size_t place = ranked.scores.column_of(model);
        const ModelRank rank =
            place < ranked.scores.models.size() ? ranked.ranking.models[place] : ModelRank{};
        table.rows.push_back(cells(scores.label(), scores.models()[model],
                                   conclusions.metrics[ranked.metric].name, summary.n, summary.mean,
                                   student_interval(summary), rank_cell(rank.rank), rank.letters));
      }
  return table;
}

Table ranking_table(const Conclusions& conclusions) {
  return {.columns = conclusions.labelled({"dataset", "metric", "model", "n", "n_shapes", "mean", "rank",
                                           "rank_low", "rank_high", "first", "group"}),
          .rows = rows_by_metric(conclusions, ranking_rows)};
}

void write_conclusions(const std::filesystem::path& folder, const std::vector<ResultRow>& rows,
                       const Conclusions& conclusions, const std::string& head) {
  const auto write = [&](const char* name, const Table& table) {
    write_file(folder / name, head + to_csv(table));
  };
  write("summary.csv", summary_table(conclusions));
  write("ranking.csv", ranking_table(conclusions));
  write("ranking_agreement.csv", agreement_table(conclusions));
  write("significance.csv", significance_table(conclusions));
  write("per_class.csv", per_class_table(rows, conclusions.metrics, conclusions.unit));
  write("human_share.csv", human_share_table(conclusions));
  write("compact.csv", compact_table(conclusions));
  write("leaders.csv", leaders_table(conclusions, find_leaders(conclusions)));
}

}  // namespace salbench
