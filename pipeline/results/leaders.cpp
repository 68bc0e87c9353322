// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/results/leaders.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "pipeline/results/compact.h"
#include "pipeline/results/table_rows.h"
#include "stages/stats/paired.h"

namespace salbench {
namespace {

constexpr std::array<std::string_view, 3> kPapers = {"auc", "nss", "lcc"};
constexpr std::size_t kLeading = 3;
constexpr std::size_t kNamed = 4;  // of models that a sentence lists

// The interval of a difference that the ranks are made of; within it 0 where the pair does not differ.
struct JointDifference {
  double mean;
  Interval interval;
  bool differs;
};

// How far model a is ahead of b, columns of the ranked scores.
JointDifference joint_lead(const RankedMetric& ranked, std::size_t a, std::size_t b, bool higher_is_better) {
  const Columns& scores = ranked.scores.scores;
  if (!higher_is_better) std::swap(a, b);
  const PairedComparison found = compare_paired(scores.column(a), scores.column(b));
  const double error = found.deviation / std::sqrt(static_cast<double>(found.n));
  const double half = ranked.ranking.critical * error;
  return {found.mean_difference,
          {found.mean_difference - half, found.mean_difference + half},
          std::abs(found.mean_difference) > half};
}

Leader leader_of(const DatasetScores& scores, const RankedMetric& ranked, const Metric& metric) {
  const std::vector<ModelRank>& ranks = ranked.ranking.models;
  const auto name = [&](std::size_t column) { return scores.models()[ranked.scores.models[column]]; };
  std::vector<std::size_t> order(ranks.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t column) { return ranks[column].rank; });
  Leader leader{.metric = &metric,
                .n_models = ranks.size(),
                .n = static_cast<std::int64_t>(ranked.scores.units.size()),
                .n_shapes = ranked.scores.n_shapes};
  for (const std::size_t column : order)
    if (ranks[column].rank_low <= 1) leader.models.push_back(name(column));
  const std::size_t best = order[0];
  const Summary summary = summarise(ranked.scores.scores.column(best));
  leader.mean = summary.mean;
  leader.interval = interval_within_range(summary, metric.name);
  if (leader.n == 0) leader.verdict = Lead::no_shape;
  if (leader.n < 2) return leader;
  if (order.size() == 1) {
    leader.verdict = Lead::only_model;
    return leader;
  }
  const JointDifference ahead = joint_lead(ranked, best, order[1], metric.higher_is_better);
  leader.second = name(order[1]);
  leader.lead = ahead.mean;
  leader.lead_interval = ahead.interval;
  if (leader.models.size() > 1) {
    leader.verdict = Lead::not_apart;
    return leader;
  }
  for (const std::size_t column : order)
    if (column != best && !joint_lead(ranked, best, column, metric.higher_is_better).differs)
      leader.near.push_back(name(column));
  leader.verdict = leader.near.empty() ? Lead::leads : Lead::not_behind;
  return leader;
}

std::string listed(const std::vector<std::string>& names) {
  if (names.size() == 1) return names[0];
  return fmt::format("{} and {}", fmt::join(names.begin(), names.end() - 1, ", "), names.back());
}

// A long list is cut: the tables have it.
std::string named(const std::vector<std::string>& models) {
  if (models.size() <= kNamed + 1) return listed(models);
  std::vector<std::string> few(models.begin(), models.begin() + kNamed);
  few.push_back(fmt::format("{} others", models.size() - kNamed));
  return listed(few);
}

std::string label_of(const std::string& metric) {
  constexpr std::array<std::string_view, 10> kShort = {"auc", "nss", "lcc", "cc",  "kl",
                                                       "sim", "ig",  "mse", "mae", "sauc"};
  if (std::ranges::find(kShort, metric) == kShort.end()) return metric;
  std::string label;
  for (const char c : metric) label += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return label;
}

std::string several(std::int64_t n, std::string_view one, std::string_view more) {
  return fmt::format("{} {}", n, n == 1 ? one : more);
}

std::string shapes_text(const std::string& dataset, std::int64_t n) {
  if (dataset == "scans") return several(n, "scan", "scans");
  return dataset == "clouds" ? several(n, "point cloud", "point clouds") : several(n, "mesh", "meshes");
}

std::string spoken(const std::string& dataset) { return dataset == "clouds" ? "point clouds" : dataset; }

// "228 scans of 19 meshes"
std::string counted(const std::string& dataset, Observation unit, std::int64_t n, std::int64_t n_shapes) {
  const std::string shapes = shapes_text(dataset, n_shapes);
  if (unit == Observation::item_class) return fmt::format("{} of {}", shapes, several(n, "class", "classes"));
  return dataset == "scans" && unit == Observation::mesh
             ? fmt::format("{} of {}", shapes, several(n, "mesh", "meshes"))
             : shapes;
}

// What several metrics say alike.
struct Clause {
  Lead verdict;
  std::vector<std::string> models, near;
  std::vector<std::string> metrics = {};  // with their figures
  std::vector<std::string> labels = {};   // without
};

std::string text_of(const Clause& clause) {
  const std::string metrics = listed(clause.metrics), first = clause.models.empty() ? "" : clause.models[0];
  switch (clause.verdict) {
    case Lead::leads:
      return fmt::format("{} leads by {}", first, metrics);
    case Lead::not_behind:
      return fmt::format("by {}, {} is behind no other model, but cannot be told apart from {}", metrics,
                         first, named(clause.near));
    case Lead::not_apart:
      return fmt::format("by {}, {} cannot be told apart", metrics, named(clause.models));
    case Lead::only_model:
      return fmt::format("{} is the only model that is scored by {}", first, metrics);
    case Lead::one_unit:
      return fmt::format("one observation does not tell how the models rank by {}", listed(clause.labels));
    case Lead::no_shape:
      return fmt::format("no shape has scores of all models by {}", listed(clause.labels));
  }
  return "";
}

// Writes the sentence of a data set, metric by metric.
class Sentence {
 public:
  Sentence(const LevelLeaders& level, Observation unit) : level_(level), unit_(unit) {}

  void add(const Leader& leader) {
    if (shapes_.empty()) shapes_ = counted_of(leader);
    const std::string label = label_of(leader.metric->name);
    Clause& clause = clause_of(leader);
    clause.metrics.push_back(fmt::format("{} ({})", label, figures(leader)));
    clause.labels.push_back(label);
  }

  std::string text() const {
    const std::string split = level_.split.empty() ? "" : fmt::format(" of split {}", level_.split);
    if (clauses_.empty())
      return fmt::format("On {}{}, no model has scores but references.", spoken(level_.dataset), split);
    std::vector<std::string> said;
    for (const Clause& clause : clauses_) said.push_back(text_of(clause));
    return fmt::format("On {}{}, {}.", shapes_, split, fmt::join(said, "; "));
  }

 private:
  std::string counted_of(const Leader& leader) const {
    return leader.n == 0 ? spoken(level_.dataset) : counted(level_.dataset, unit_, leader.n, leader.n_shapes);
  }

  Clause& clause_of(const Leader& leader) {
    const auto same = [](std::vector<std::string> a, std::vector<std::string> b) {
      std::ranges::sort(a);
      std::ranges::sort(b);
      return a == b;
    };
    for (Clause& clause : clauses_)
      if (clause.verdict == leader.verdict && same(clause.models, leader.models) &&
          same(clause.near, leader.near))
        return clause;
    return clauses_.emplace_back(Clause{leader.verdict, leader.models, leader.near});
  }

  // "mean 0.613, 95 % interval 0.590 to 0.636": whose it is where that is not clear, and over what if that
  // is not what the sentence begins with.
  std::string figures(const Leader& leader) {
    const bool first = !std::exchange(explained_, true);
    const std::string whose =
        leader.verdict == Lead::not_apart && !leader.models.empty() ? leader.models[0] + " " : "";
    std::string text = first ? fmt::format("{}mean {:.3f}", whose, leader.mean)
                             : fmt::format("{}{:.3f}", whose, leader.mean);
    if (!std::isnan(leader.interval.low))
      text += fmt::format(", {}{:.3f} to {:.3f}", first ? "95 % interval " : "", leader.interval.low,
                          leader.interval.high);
    else
      text += ", no interval";
    const std::string over = counted_of(leader);
    return over == shapes_ ? text : fmt::format("{}, on {}", text, over);
  }

  const LevelLeaders& level_;
  Observation unit_;
  std::string shapes_;
  std::vector<Clause> clauses_;
  bool explained_ = false;
};

}  // namespace

std::vector<std::string> leading_metrics(const Metrics& metrics) {
  std::vector<std::string> names;
  for (const std::string_view name : kPapers)
    if (std::ranges::find(metrics, name, &Metric::name) != metrics.end()) names.emplace_back(name);
  for (const Metric& metric : metrics)
    if (names.size() < kLeading && std::ranges::find(names, metric.name) == names.end())
      names.push_back(metric.name);
  return names;
}

std::vector<LevelLeaders> find_leaders(const Conclusions& conclusions) {
  const std::vector<std::string> spoken_of = leading_metrics(conclusions.metrics);
  std::vector<LevelLeaders> levels;
  for (const auto& [scores, metrics] : conclusions.datasets) {
    LevelLeaders level{.dataset = scores.dataset()};
    if (scores.in_splits()) level.split = std::get<std::string>(scores.label()[1]);
    for (const RankedMetric& ranked : metrics)
      if (!ranked.scores.models.empty())
        level.metrics.push_back(leader_of(scores, ranked, conclusions.metrics[ranked.metric]));
    Sentence sentence(level, conclusions.unit);
    for (const std::string& name : spoken_of)
      for (const Leader& leader : level.metrics)
        if (leader.metric->name == name) sentence.add(leader);
    level.sentence = sentence.text();
    levels.push_back(std::move(level));
  }
  return levels;
}

Table leaders_table(const Conclusions& conclusions, const std::vector<LevelLeaders>& leaders) {
  Table table{.columns = conclusions.labelled({"dataset", "metric", "verdict", "leaders", "mean", "ci95_low",
                                               "ci95_high", "second", "lead", "lead_low", "lead_high", "n",
                                               "n_shapes", "sentence"}),
              .rows = {}};
  const bool in_splits = table.columns[1] == "split";
  for (const LevelLeaders& level : leaders) {
    std::vector<Cell> label = {level.dataset};
    if (in_splits) label.emplace_back(level.split);
    const std::string none;
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    table.rows.push_back(cells(label, none, none, none, kNone, Interval{}, none, kNone, Interval{}, none,
                               none, level.sentence));
    for (const Leader& leader : level.metrics) {
      LevelLeaders alone{.dataset = level.dataset, .split = level.split};
      Sentence sentence(alone, conclusions.unit);
      sentence.add(leader);
      table.rows.push_back(cells(label, leader.metric->name, std::string(name_of(leader.verdict)),
                                 fmt::format("{}", fmt::join(leader.models, ", ")), leader.mean,
                                 leader.interval, leader.second, leader.lead, leader.lead_interval, leader.n,
                                 leader.n_shapes, sentence.text()));
    }
  }
  return table;
}

std::string leading_text(const std::vector<LevelLeaders>& leaders) {
  std::string text;
  for (const LevelLeaders& level : leaders) text += level.sentence + "\n";
  return text;
}

}  // namespace salbench
