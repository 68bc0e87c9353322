// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/quality/human_calibration.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "pipeline/results/human_curves.h"
#include "stages/core/rng.h"
#include "stages/stats/human_scale.h"
#include "stages/stats/summary.h"

namespace salbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A row of normal values with the means and covariances of the columns.
std::vector<double> drawn_like(const Columns& values, const std::vector<double>& means, Rng& rng) {
  std::vector<double> row = means;
  const double scale = 1 / std::sqrt(static_cast<double>(values.units()) - 1);
  for (std::size_t u = 0; u < values.units(); ++u) {
    const double weight = scale * rng.normal();
    for (std::size_t c = 0; c < values.count; ++c) row[c] += weight * (values.at(u, c) - means[c]);
  }
  return row;
}

struct DataSet {
  std::vector<ResultRow> rows;
  std::vector<MeshCurve> curves;
};

DataSet simulate(const PeopleModel& model, const std::vector<double>& means, std::size_t meshes, Rng& rng) {
  DataSet made;
  const std::size_t k = model.models.size();
  for (std::size_t mesh = 0; mesh < meshes; ++mesh) {
    const std::vector<double> values = drawn_like(model.values, means, rng);
    const std::string item = std::to_string(mesh);
    for (std::size_t m = 0; m < k; ++m)
      made.rows.push_back({"meshes", item, "", "", model.models[m], Scores{{values[m]}}});
    MeshCurve& curve = made.curves.emplace_back(MeshCurve{item, "", {}});
    for (std::size_t c = k; c < values.size(); ++c) curve.curve.push_back(Scores{{values[c]}});
  }
  return made;
}

class PeopleRates {
 public:
  PeopleRates(const PeopleModel& model, const std::vector<double>& means)
      : model_(model),
        k_(model.models.size()),
        curve_(means.begin() + static_cast<std::ptrdiff_t>(k_), means.end()) {
    for (std::size_t m = 0; m < k_; ++m) mean_[model.models[m]] = means[m];
  }

  void add(const DataSet& data, std::uint64_t seed) {
    const Metrics metrics{model_.metric};
    const Conclusions conclusions = conclude(data.rows, metrics, {}, seed);
    add_shares(human_share_table(conclusions));
    add_places(human_equivalents_table(data.curves, data.rows, conclusions));
    add_differences(human_curve_differences_table(data.curves, metrics, Observation::mesh));
  }

  // Those that there were cases of.
  std::vector<Rate> rates() const {
    std::vector<Rate> found{share_, place_, difference_};
    std::erase_if(found, [](const Rate& rate) { return rate.cases == 0; });
    return found;
  }

 private:
  static double number(const Table& table, const std::vector<Cell>& row, std::string_view column) {
    const Cell& cell = row.at(at(table, column));
    if (const auto* whole = std::get_if<std::int64_t>(&cell)) return static_cast<double>(*whole);
    return std::get<double>(cell);
  }
  static std::string text(const Table& table, const std::vector<Cell>& row, std::string_view column) {
    return std::get<std::string>(row.at(at(table, column)));
  }
  static std::size_t at(const Table& table, std::string_view column) {
    return static_cast<std::size_t>(std::ranges::find(table.columns, column) - table.columns.begin());
  }

  static void count(Rate& rate, double low, double truth, double high) {
    if (std::isnan(low) || std::isnan(high)) return;
    ++rate.cases;
    rate.hits += low <= truth && truth <= high ? 1 : 0;
  }

  void add_shares(const Table& table) {
    for (const auto& row : table.rows)
      count(share_, number(table, row, "ci95_low"),
            (mean_.at(text(table, row, "model")) - mean_.at("RS")) / (mean_.at("HS") - mean_.at("RS")),
            number(table, row, "ci95_high"));
  }

  void add_places(const Table& table) {
    const auto end = [&](const std::vector<Cell>& row, const char* bound, const char* value) {
      const std::string open = text(table, row, bound);
      return open.empty() ? number(table, row, value) : open.starts_with("<") ? -kInfinity : kInfinity;
    };
    for (const auto& row : table.rows) {
      const double truth =
          first_reached(curve_, mean_.at(text(table, row, "model")), model_.metric.higher_is_better);
      if (std::isfinite(truth))
        count(place_, end(row, "low_bound", "ci95_low"), truth, end(row, "high_bound", "ci95_high"));
    }
  }

  void add_differences(const Table& table) {
    for (const auto& row : table.rows) {
      const auto point = [&](const char* column) {
        return curve_.at(static_cast<std::size_t>(number(table, row, column)) - 1);
      };
      count(difference_, number(table, row, "ci95_low"),
            point("to_participants") - point("from_participants"), number(table, row, "ci95_high"));
    }
  }

  const PeopleModel& model_;
  std::size_t k_;
  std::vector<double> curve_;
  std::map<std::string, double> mean_;
  Rate share_{"interval of a share of HS", kConfidence}, place_{"interval of k participants", kConfidence},
      difference_{"interval of what participants add", kConfidence};
};

}  // namespace

PeopleModel people_model(const ScoreFile& scores, const std::filesystem::path& curve_by_mesh,
                         std::size_t metric) {
  const DatasetScores all(scores.rows, "meshes", Observation::mesh);
  const Table table = read_csv(curve_by_mesh);
  const auto items = text_column(table, "item"), metrics = text_column(table, "metric");
  const auto n = number_column(table, "n"), value = number_column(table, "value");
  std::map<std::string, std::map<double, double>> curves;
  std::size_t longest = 0;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (metrics[i] != scores.metrics[metric].name || std::isnan(value[i])) continue;
    curves[items[i]][n[i]] = value[i];
    longest = std::max(longest, curves[items[i]].size());
  }
  std::map<std::string, std::map<std::string, double>> rows;
  for (const ResultRow& row : scores.rows)
    if (row.dataset == "meshes" && !std::isnan(row.value(metric)))
      rows[row.item][row.model] = row.value(metric);
  PeopleModel model{scores.metrics[metric], all.models(), {all.models().size() + longest, {}}};
  for (const auto& [item, of_models] : rows) {
    if (of_models.size() < all.models().size() || curves[item].size() < longest) continue;
    for (const std::string& name : all.models()) model.values.values.push_back(of_models.at(name));
    for (const auto& [participants, of_curve] : curves[item]) model.values.values.push_back(of_curve);
  }
  const auto lacks = [&](const char* name) { return std::ranges::count(model.models, name) == 0; };
  if (model.values.units() < 2 || longest == 0 || lacks("HS") || lacks("RS")) model.models.clear();
  return model;
}

std::vector<Rate> calibrate_people(const PeopleModel& model, std::size_t meshes, std::size_t data_sets,
                                   std::uint64_t seed) {
  const std::vector<double> means = model.values.means();
  PeopleRates rates(model, means);
  for (std::size_t i = 0; i < data_sets; ++i) {
    Rng rng(seed, "calibrate people", std::to_string(i));
    rates.add(simulate(model, means, meshes, rng), seed + i);
  }
  return rates.rates();
}

}  // namespace salbench
