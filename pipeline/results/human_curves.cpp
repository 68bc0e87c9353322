// SPDX-License-Identifier: GPL-3.0-or-later
// A point of the human curve stands among the models as one more of them, under a name that no model can
// have, so that units and shapes are chosen where they are for everything else.
#include "pipeline/results/human_curves.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "io/file.h"
#include "pipeline/results/table_rows.h"
#include "stages/core/check.h"
#include "stages/stats/human_scale.h"
#include "stages/stats/paired.h"
#include "stages/stats/summary.h"

namespace salbench {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

ResultRow row_of(const MeshCurve& mesh, std::string name, std::vector<double> values) {
  return {std::string(shapes_name(kMeshes)), mesh.item, mesh.category, "", std::move(name),
          Scores{std::move(values)}};
}

// The scores of models on meshes, if any, followed by the curve: a column per number of participants.
class CurveScores {
 public:
  CurveScores(const std::vector<MeshCurve>& curves, const std::vector<ResultRow>& scores, Observation unit)
      : rows_(rows_of(curves, scores)), scores_(rows_, shapes_name(kMeshes), unit) {
    for (const MeshCurve& mesh : curves) longest_ = std::max(longest_, mesh.curve.size());
    // Units may leave meshes out, and curves with them.
    for (std::size_t n = 1; n <= longest_; ++n)
      if (const std::size_t found = scores_.find(name_of_point(n)); found < scores_.models().size())
        columns_.push_back(found);
  }

  CurveScores(const CurveScores&) = delete;
  CurveScores& operator=(const CurveScores&) = delete;

  const DatasetScores& scores() const { return scores_; }
  // Columns for 1, 2, ... participants.
  std::span<const std::size_t> curve() const { return columns_; }

 private:
  static std::string name_of_point(std::size_t n) { return fmt::format("{} participants", n); }

  static std::vector<ResultRow> rows_of(const std::vector<MeshCurve>& curves,
                                        const std::vector<ResultRow>& scores) {
    std::vector<ResultRow> rows;
    std::ranges::copy_if(scores, std::back_inserter(rows),
                         [](const ResultRow& row) { return row.dataset == shapes_name(kMeshes); });
    for (const MeshCurve& mesh : curves)
      for (std::size_t i = 0; i < mesh.curve.size(); ++i)
        rows.push_back(row_of(mesh, name_of_point(i + 1), mesh.curve[i].values));
    return rows;
  }

  std::vector<ResultRow> rows_;  // that scores_ refers to
  DatasetScores scores_;
  std::size_t longest_ = 0;
  std::vector<std::size_t> columns_;
};

// Reliability of the whole, from the correlation of its halves. [spearman1910] [brown1910]
double reliability(double r) { return std::isnan(r) ? r : r > 0 ? 2 * r / (1 + r) : 0; }

// The metric that is Pearson's correlation of two maps, as reliability takes it.
std::optional<std::size_t> correlation_among(const Metrics& metrics) {
  const auto found = std::ranges::find(metrics, "cc", &Metric::name);
  if (found == metrics.end()) return std::nullopt;
  return static_cast<std::size_t>(found - metrics.begin());
}

std::vector<Cell> difference_cells(const DatasetScores& scores, std::size_t metric, std::size_t fewer,
                                   std::size_t more) {
  const std::array columns{more, fewer};
  const UnitScores both = scores.averaged(metric, columns, {});
  const PairedComparison found =
      both.units.empty() ? PairedComparison{} : compare_paired(both.scores.column(0), both.scores.column(1));
  return cells(found.n, both.n_shapes, found.mean_difference, found.interval, found.t_p,
               found.equivalence_interval);
}

// Up to which number of participants the curve is used, being that of at least half of the meshes.
std::size_t usable_length(const CurveScores& scores, std::size_t metric,
                          std::span<const std::size_t> required) {
  std::size_t length = 0;
  std::int64_t n_shapes = 0;
  for (std::size_t n = 1; n <= scores.curve().size(); ++n) {
    const auto found = scores.scores().averaged(metric, scores.curve().first(n), required).n_shapes;
    if (n == 1) n_shapes = found;
    if (found == 0 || 2 * found < n_shapes) break;
    length = n;
  }
  return length;
}

double within(double participants) { return std::isfinite(participants) ? participants : kNone; }

std::string bound(double participants, std::size_t length) {
  if (!std::isinf(participants)) return "";
  return participants < 0 ? "<1" : fmt::format(">{}", length);
}

bool contains(const Interval& interval, double value) {
  return interval.low <= value && value <= interval.high;
}

// One metric of human_equivalents_table.
class EquivalentsOfMetric {
 public:
  EquivalentsOfMetric(const CurveScores& scores, const DatasetScores& models, std::size_t metric,
                      const Conclusions& conclusions)
      : scores_(scores),
        models_(models),
        metric_(metric),
        conclusions_(conclusions),
        competitors_(models.competitors(metric)),
        length_(usable_length(scores, metric, competitors_)),
        found_(models.models().size()) {
    if (length_ == 0) return;
    const std::vector<std::size_t> scored = models.scored(metric);
    // References bound nobody else's meshes; mostly they have scores of all of them.
    if (beside_curve(scored).n_shapes == beside_curve(competitors_).n_shapes) {
      add(scored);
      return;
    }
    add(competitors_);
    for (const std::size_t model : scored)
      if (models.is_reference(model)) add({model});
  }

  Rows rows() const {
    Rows rows;
    for (std::size_t model = 0; model < found_.size(); ++model) {
      const Found& found = found_[model];
      const auto& [k, interval, crossings] = found.equivalent;
      rows.push_back(cells(models_.dataset(), conclusions_.metrics[metric_].name, models_.models()[model],
                           found.units, found.n_shapes, length_, found.mean, within(k), within(interval.low),
                           within(interval.high), bound(k, length_), bound(interval.low, length_),
                           bound(interval.high, length_), crossings, remark_on(model)));
    }
    return rows;
  }

 private:
  struct Found {
    std::size_t units = 0;
    std::int64_t n_shapes = 0;
    double mean = kNone;
    Equivalent equivalent = {};
  };

  // Columns: the curve, then the models, on the same meshes.
  UnitScores beside_curve(const std::vector<std::size_t>& models) const {
    const auto curve = scores_.curve().first(length_);
    std::vector<std::size_t> columns(curve.begin(), curve.end());
    columns.insert(columns.end(), models.begin(), models.end());
    return scores_.scores().averaged(metric_, columns, competitors_);
  }

  void add(const std::vector<std::size_t>& models) {
    const UnitScores beside = beside_curve(models);
    if (beside.units.empty()) return;
    const std::vector<double> means = beside.scores.means();
    const std::vector<Equivalent> made =
        equivalents(beside.scores, conclusions_.bootstrap->means(beside.scores), length_,
                    conclusions_.metrics[metric_].higher_is_better);
    for (std::size_t i = 0; i < models.size(); ++i)
      found_[models[i]] = {beside.units.size(), beside.n_shapes, means[length_ + i], made[i]};
  }

  std::string remark_on(std::size_t model) const {
    const Found& found = found_[model];
    const std::vector<std::size_t> scored = models_.scored(metric_);
    if (std::ranges::find(scored, model) == scored.end()) return "no scores";
    if (found.units == 0) return "no mesh has a human curve and scores of all models";
    if (found.units < kMinUnitsOfPercentiles)
      return fmt::format("no interval: fewer than {} units", kMinUnitsOfPercentiles);
    if (std::isnan(found.equivalent.interval.low)) return "no interval: the values do not vary";
    return remark_on_scale(model);
  }

  // One participant is worth one, unless the target of a model's score, all participants, makes another score
  // of the same map than that of the curve, as many others.
  std::string remark_on_scale(std::size_t model) const {
    const std::size_t one = models_.find("HS");
    if (one == found_.size() || one == model) return "";
    const Equivalent& of_one = found_[one].equivalent;
    if (std::isnan(of_one.interval.low) || contains(of_one.interval, 1)) return "";
    const double k = of_one.participants;
    return fmt::format("not a number of people: one participant (HS) has k {} here",
                       std::isinf(k) ? bound(k, length_) : fmt::format("{:.2f}", k));
  }

  const CurveScores& scores_;
  const DatasetScores& models_;
  std::size_t metric_;
  const Conclusions& conclusions_;
  std::vector<std::size_t> competitors_;
  std::size_t length_;
  std::vector<Found> found_;  // [model]
};

}  // namespace

Table human_curve_table(const std::vector<MeshCurve>& curves, const Metrics& metrics) {
  Table table{.columns = {"n", "metric", "n_meshes", "mean", "sd", "ci95_low", "ci95_high"}, .rows = {}};
  std::size_t longest = 0;
  for (const MeshCurve& mesh : curves) longest = std::max(longest, mesh.curve.size());
  for (std::size_t i = 0; i < longest; ++i) {
    for (std::size_t m = 0; m < metrics.size(); ++m) {
      std::vector<double> values;
      for (const MeshCurve& mesh : curves)
        if (i < mesh.curve.size()) values.push_back(mesh.curve[i].values.at(m));
      const Summary summary = summarise(values);
      table.rows.push_back(
          cells(i + 1, metrics[m].name, summary.n, summary.mean, summary.sd, student_interval(summary)));
    }
  }
  return table;
}

Table human_curve_by_mesh_table(const std::vector<MeshCurve>& curves, const Metrics& metrics) {
  Table table{.columns = {"item", "class", "n", "metric", "value", "reliability"}, .rows = {}};
  const std::optional<std::size_t> cc = correlation_among(metrics);
  for (const MeshCurve& mesh : curves)
    for (std::size_t i = 0; i < mesh.curve.size(); ++i)
      for (std::size_t m = 0; m < metrics.size(); ++m) {
        const double value = mesh.curve[i].values.at(m);
        table.rows.push_back(cells(mesh.item, mesh.category, i + 1, metrics[m].name, value,
                                   m == cc ? reliability(value) : kNone));
      }
  return table;
}

Table human_curve_differences_table(const std::vector<MeshCurve>& curves, const Metrics& metrics,
                                    Observation unit) {
  const CurveScores scores(curves, {}, unit);
  const std::span<const std::size_t> curve = scores.curve();
  return {.columns = {"metric", "from_participants", "to_participants", "n", "n_shapes", "mean_difference",
                      "ci95_low", "ci95_high", "t_p", "ci90_low", "ci90_high"},
          .rows = rows_of_each(metrics.size(), [&](std::size_t m) {
            Rows rows;
            for (std::size_t a = 0; a < curve.size(); ++a)
              for (std::size_t b = a + 1; b < curve.size(); ++b)
                rows.push_back(cells(metrics[m].name, a + 1, b + 1,
                                     difference_cells(scores.scores(), m, curve[a], curve[b])));
            return rows;
          })};
}

Table human_equivalents_table(const std::vector<MeshCurve>& curves, const std::vector<ResultRow>& rows,
                              const Conclusions& conclusions) {
  Table table{
      .columns = {"dataset", "metric", "model", "n", "n_shapes", "largest_group", "mean", "k", "ci95_low",
                  "ci95_high", "k_bound", "low_bound", "high_bound", "crossings", "remark"},
      .rows = {}};
  const DatasetConclusions* meshes = conclusions.of(shapes_name(kMeshes));
  if (meshes == nullptr) return table;
  const CurveScores scores(curves, rows, conclusions.unit);
  for (std::size_t model = 0; model < meshes->scores.models().size(); ++model)
    CHECK_EQ(meshes->scores.models()[model], scores.scores().models()[model]);
  table.rows = rows_of_each(conclusions.metrics.size(), [&](std::size_t m) {
    return EquivalentsOfMetric(scores, meshes->scores, m, conclusions).rows();
  });
  return table;
}

Table human_reliability_table(const std::vector<MeshCurve>& curves, const Metrics& metrics,
                              Observation unit) {
  Table table{.columns = {"metric", "n", "n_shapes", "fewest_participants", "most_participants", "split_half",
                          "mean", "sd", "ci95_low", "ci95_high"},
              .rows = {}};
  const std::optional<std::size_t> cc = correlation_among(metrics);
  if (!cc) return table;
  std::vector<ResultRow> rows;  // metrics: the correlation of the halves, and the reliability
  std::vector<std::size_t> participants;
  for (const MeshCurve& mesh : curves) {
    const auto last = std::find_if(mesh.curve.rbegin(), mesh.curve.rend(),
                                   [&](const Scores& scores) { return !std::isnan(scores.values.at(*cc)); });
    if (last == mesh.curve.rend()) continue;
    participants.push_back(2 * static_cast<std::size_t>(mesh.curve.rend() - last));
    const double r = last->values.at(*cc);
    rows.push_back(row_of(mesh, "people", {r, reliability(r)}));
  }
  const DatasetScores scores(rows, shapes_name(kMeshes), unit);
  if (scores.models().empty()) return table;
  const UnitScores found = scores.own(1, 0);
  const Summary summary = summarise(found.scores.values);
  const auto [fewest, most] = std::ranges::minmax(participants);
  table.rows.push_back(cells(metrics[*cc].name, summary.n, found.n_shapes, fewest, most,
                             summarise(scores.own(0, 0).scores.values).mean, summary.mean, summary.sd,
                             student_interval(summary)));
  return table;
}

void write_human_curves(const std::filesystem::path& folder, const std::vector<MeshCurve>& curves,
                        const std::vector<ResultRow>& rows, const Conclusions& conclusions,
                        const std::string& head) {
  const auto write = [&](const char* name, auto&& make) {
    if (curves.empty())
      remove_file(folder / name);  // of an earlier run
    else
      write_file(folder / name, head + to_csv(make()));
  };
  const Metrics& metrics = conclusions.metrics;
  write("human_curve.csv", [&] { return human_curve_table(curves, metrics); });
  write("human_curve_by_mesh.csv", [&] { return human_curve_by_mesh_table(curves, metrics); });
  write("human_curve_differences.csv",
        [&] { return human_curve_differences_table(curves, metrics, conclusions.unit); });
  write("human_equivalents.csv", [&] { return human_equivalents_table(curves, rows, conclusions); });
  write("human_reliability.csv", [&] { return human_reliability_table(curves, metrics, conclusions.unit); });
}

}  // namespace salbench
