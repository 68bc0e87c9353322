// SPDX-License-Identifier: GPL-3.0-or-later
// Rankings are compared by the signs of the differences of their models, pair by pair; signs of all resamples
// are kept in a byte each, so that thousands of pairs of metrics cost seconds.
#include <algorithm>
#include <cmath>
#include <memory>

#include "pipeline/results/table_rows.h"
#include "stages/stats/summary.h"

namespace salbench {
namespace {

// The order of the models by one metric, in the sample (row 0) and in each resample.
struct Orders {
  std::size_t pairs = 0;
  std::vector<std::int8_t> signs;  // rows x pairs of models: which of the two is better
};

Orders orders_of(const Columns& scores, const Columns& resampled, bool higher_is_better) {
  Orders orders{scores.count * (scores.count - 1) / 2, {}};
  const auto add = [&](std::span<const double> means) {
    for (std::size_t a = 0; a < means.size(); ++a)
      for (std::size_t b = a + 1; b < means.size(); ++b) {
        const double ahead = higher_is_better ? means[a] - means[b] : means[b] - means[a];
        orders.signs.push_back(static_cast<std::int8_t>((ahead > 0 ? 1 : 0) - (ahead < 0 ? 1 : 0)));
      }
  };
  orders.signs.reserve((1 + resampled.units()) * orders.pairs);
  add(scores.means());
  for (std::size_t r = 0; r < resampled.units(); ++r)
    add(std::span(resampled.values).subspan(r * resampled.count, resampled.count));
  return orders;
}

// Kendall's tau-b of a row.
double tau(const Orders& x, const Orders& y, std::size_t row) {
  int agreement = 0, untied_x = 0, untied_y = 0;
  for (std::size_t p = row * x.pairs; p < (row + 1) * x.pairs; ++p) {
    agreement += x.signs[p] * y.signs[p];
    untied_x += x.signs[p] * x.signs[p];
    untied_y += y.signs[p] * y.signs[p];
  }
  return agreement / std::sqrt(static_cast<double>(untied_x) * untied_y);
}

struct Agreement {
  double tau = std::numeric_limits<double>::quiet_NaN();
  Interval interval = {};
};

Agreement agreement_of(const Orders& x, const Orders& y) {
  const std::size_t rows = x.signs.size() / x.pairs;
  Agreement found{tau(x, y, 0)};
  if (rows == 1) return found;
  std::vector<double> taus(rows - 1);
  for (std::size_t row = 1; row < rows; ++row) taus[row - 1] = tau(x, y, row);
  std::erase_if(taus, [](double value) { return std::isnan(value); });  // all models level
  if (taus.empty()) return found;
  constexpr double kTail = (1 - kConfidence) / 2;
  found.interval = {quantile_in_place(taus, kTail), quantile_in_place(taus, 1 - kTail)};
  return found;
}

// The scores of one metric over what two have in common.
struct Common {
  std::vector<std::size_t> models, units;

  Common(const UnitScores& a, const UnitScores& b) {
    std::ranges::set_intersection(a.models, b.models, std::back_inserter(models));
    std::ranges::set_intersection(a.units, b.units, std::back_inserter(units));
  }

  bool is_all_of(const UnitScores& scores) const { return models == scores.models && units == scores.units; }

  Columns of(const UnitScores& scores) const {
    Columns columns{models.size(), {}};
    const auto place = [](const std::vector<std::size_t>& all, std::size_t one) {
      return static_cast<std::size_t>(std::ranges::lower_bound(all, one) - all.begin());
    };
    for (const std::size_t unit : units)
      for (const std::size_t model : models)
        columns.values.push_back(scores.scores.at(place(scores.units, unit), place(scores.models, model)));
    return columns;
  }
};

class AgreementOfMetrics {
 public:
  AgreementOfMetrics(const Conclusions& conclusions, const DatasetConclusions& dataset)
      : conclusions_(conclusions), dataset_(dataset), own_(dataset.metrics.size()) {
    parallel_ranges(own_.size(), 1, [&](std::size_t m, std::size_t) {
      const RankedMetric& ranked = dataset_.metrics[m];
      if (ranked.scores.units.size() >= 2 && ranked.scores.models.size() >= 2)
        own_[m] =
            std::make_shared<Orders>(orders_of(ranked.scores.scores, ranked.resampled, higher_is_better(m)));
    });
  }

  // One row; none where the two have fewer than two models or units in common.
  Rows rows(std::size_t a, std::size_t b) const {
    const Common common(dataset_.metrics[a].scores, dataset_.metrics[b].scores);
    if (common.models.size() < 2 || common.units.size() < 2) return {};
    const Agreement found = agreement_of(*orders(a, common), *orders(b, common));
    return {cells(dataset_.scores.label(), conclusions_.metrics[a].name, conclusions_.metrics[b].name,
                  common.units.size(), common.models.size(), found.tau, found.interval)};
  }

 private:
  bool higher_is_better(std::size_t m) const { return conclusions_.metrics[m].higher_is_better; }

  std::shared_ptr<const Orders> orders(std::size_t m, const Common& common) const {
    const UnitScores& scores = dataset_.metrics[m].scores;
    if (common.is_all_of(scores)) return own_[m];
    const Columns columns = common.of(scores);
    return std::make_shared<Orders>(
        orders_of(columns, conclusions_.bootstrap->means(columns), higher_is_better(m)));
  }

  const Conclusions& conclusions_;
  const DatasetConclusions& dataset_;
  std::vector<std::shared_ptr<const Orders>> own_;  // [metric], over all its models and units
};

}  // namespace

Table agreement_table(const Conclusions& conclusions) {
  Table table{.columns = conclusions.labelled(
                  {"dataset", "metric_a", "metric_b", "n", "n_models", "tau", "ci95_low", "ci95_high"}),
              .rows = {}};
  for (const DatasetConclusions& dataset : conclusions.datasets) {
    const AgreementOfMetrics agreement(conclusions, dataset);
    const std::size_t n = dataset.metrics.size();
    const Rows rows = rows_of_each(n * n, [&](std::size_t pair) {
      return pair / n < pair % n ? agreement.rows(pair / n, pair % n) : Rows{};
    });
    table.rows.insert(table.rows.end(), rows.begin(), rows.end());
  }
  return table;
}

}  // namespace salbench
