// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/results/statements.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <sstream>

#include <fmt/format.h>

#include "pipeline/results/pairs.h"
#include "pipeline/results/table_rows.h"
#include "stages/core/errors.h"
#include "stages/stats/summary.h"

namespace salbench {
namespace {

constexpr const char* kHolds = "holds";
constexpr const char* kDoesNot = "does not hold";
constexpr const char* kUndecided = "undecided";

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream in(text);
  return {std::istream_iterator<std::string>(in), {}};
}

// As the paper reads its test: what is not significant is no difference.
const char* verdict_by_shapes(Relation relation, const RankSum& test, bool higher_is_better) {
  if (std::isnan(test.p_value)) return "";
  const bool significant = test.p_value < kLevel, better = higher_is_better ? test.z > 0 : test.z < 0;
  switch (relation) {
    case Relation::above:
      return significant && better ? kHolds : kDoesNot;
    case Relation::same:
      return significant ? kDoesNot : kHolds;
    case Relation::differ:
      return significant ? kHolds : kDoesNot;
  }
  return "";
}

const char* verdict_by_units(const Statement& said, const PairedComparison& found, bool higher_is_better) {
  if (found.n < 2) return "";
  const bool above = found.interval.low > 0, below = found.interval.high < 0;
  const bool equivalent =
      -said.margin < found.equivalence_interval.low && found.equivalence_interval.high < said.margin;
  switch (said.relation) {
    case Relation::above:
      if (above || below) return above == higher_is_better ? kHolds : kDoesNot;
      break;
    case Relation::same:
      if (equivalent || above || below) return equivalent ? kHolds : kDoesNot;
      break;
    case Relation::differ:
      if (equivalent || above || below) return above || below ? kHolds : kDoesNot;
      break;
  }
  return kUndecided;
}

// The pair of the statement with what corrects it for all pairs; empty where one of the models has no scores.
ModelPair pair_of(const DatasetScores& scores, std::size_t metric, const std::string& a,
                  const std::string& b) {
  const std::size_t first = scores.find(a), second = scores.find(b);
  if (std::max(first, second) == scores.models().size()) return {};
  ModelPair found = compare_models(scores, metric, first, second);
  for (const ModelPair& pair : model_pairs(scores, metric))
    if (std::minmax(pair.a, pair.b) == std::minmax(found.a, found.b)) found.holm = pair.holm;
  return found;
}

std::vector<Cell> statement_row(const Statement& said, const std::string& a, const std::string& b,
                                const ModelPair& pair, bool higher_is_better) {
  const PairedComparison& found = pair.by_unit;
  return cells(said.section, said.text, said.word, said.dataset, said.metric,
               std::string(name_of(said.relation)), a, b, pair.n_shapes, pair.by_shape.z,
               pair.by_shape.p_value, verdict_by_shapes(said.relation, pair.by_shape, higher_is_better),
               found.n, found.mean_difference, found.interval, found.equivalence_interval, said.margin,
               verdict_by_units(said, found, higher_is_better), pair.holm);
}

}  // namespace

std::vector<Statement> read_statements(const std::filesystem::path& path) {
  const Table table = read_csv(path);
  const auto text = [&](const char* name) { return text_column(table, name); };
  const std::vector<std::string> sections = text("section"), claims = text("claim"), words = text("word"),
                                 datasets = text("dataset"), metrics = text("metric"), checks = text("check"),
                                 a = text("a"), b = text("b");
  const std::vector<double> margins = number_column(table, "margin");
  std::vector<Statement> found;
  for (std::size_t i = 0; i < claims.size(); ++i) {
    Relation relation{};
    if (!parse_option(checks[i], relation) || words[i].empty()) continue;
    if (std::ranges::find(kShapeNames, datasets[i]) == kShapeNames.end())
      throw InputError(fmt::format("{}:{}: data set '{}', expected one of {}", table.name, table.lines[i],
                                   datasets[i], fmt::join(kShapeNames, ", ")));
    if (margins[i] <= 0)
      throw InputError(
          fmt::format("{}:{}: margin {}, expected above 0", table.name, table.lines[i], margins[i]));
    found.push_back({sections[i], claims[i], words[i], datasets[i], metrics[i], relation, words_of(a[i]),
                     words_of(b[i]), margins[i]});
  }
  return found;
}

Table statements_table(const Conclusions& conclusions, const std::vector<Statement>& statements) {
  Table table{
      .columns = split_list("section,claim,word,dataset,metric,check,model_a,model_b,n_shapes,rank_sum_z,"
                            "rank_sum_p,by_shapes,n,mean_difference,ci95_low,ci95_high,ci90_low,"
                            "ci90_high,margin,by_units,signed_rank_p_holm"),
      .rows = {}};
  for (const Statement& said : statements) {
    const auto metric = std::ranges::find(conclusions.metrics, said.metric, &Metric::name);
    const DatasetConclusions* dataset = conclusions.of(said.dataset);
    if (metric == conclusions.metrics.end() || dataset == nullptr) continue;
    const auto number = static_cast<std::size_t>(metric - conclusions.metrics.begin());
    for (const std::string& a : said.a)
      for (const std::string& b : said.b)
        table.rows.push_back(
            statement_row(said, a, b, pair_of(dataset->scores, number, a, b), metric->higher_is_better));
  }
  return table;
}

}  // namespace salbench
