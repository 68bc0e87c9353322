// SPDX-License-Identifier: GPL-3.0-or-later
// Conclusions from a table of scores in memory (pipeline/results), as `salbench conclusions` draws them from
// a file.
#include <algorithm>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "pipeline/results/conclusions.h"
#include "pipeline/results/pairs.h"
#include "pipeline/results/score_file.h"
#include "python/arrays.h"
#include "python/computing.h"
#include "python/module.h"
#include "python/options.h"

namespace salbench::python {
namespace {

// Columns by name: lists of texts, or arrays of numbers. All are as long.
Table table_from(const py::dict& columns) {
  Table table{.columns = {}, .rows = {}, .name = "table"};
  std::optional<std::size_t> n;
  for (const auto& [key, values] : columns) {
    const auto name = std::string(py::str(key));
    std::vector<Cell> cells;
    if (py::isinstance<py::list>(values)) {
      for (const py::handle text : values) cells.emplace_back(std::string(py::str(text)));
    } else {
      const auto numbers = field({values, name.c_str()});
      cells.assign(numbers.values.begin(), numbers.values.end());
    }
    if (n && cells.size() != *n) throw py::value_error("table has columns of several lengths");
    n = cells.size();
    table.columns.push_back(name);
    table.rows.resize(*n);
    for (std::size_t row = 0; row < *n; ++row) table.rows[row].push_back(std::move(cells[row]));
  }
  for (std::size_t row = 0; row < table.rows.size(); ++row) table.lines.push_back(row);
  return table;
}

// The metrics of these names alone, in their order.
ScoreFile only(ScoreFile file, const std::vector<std::string>& names) {
  std::vector<std::size_t> chosen;
  for (const std::string& name : names) {
    const auto found = std::ranges::find(file.metrics, name, &Metric::name);
    if (found == file.metrics.end())
      throw py::value_error(fmt::format(
          "metrics: '{}' is no metric of the program: name it in higher_is_better or lower_is_better", name));
    chosen.push_back(static_cast<std::size_t>(found - file.metrics.begin()));
  }
  Metrics metrics;
  for (const std::size_t m : chosen) metrics.push_back(file.metrics[m]);
  file.metrics = std::move(metrics);
  for (ResultRow& row : file.rows) {
    std::vector<double> values;
    for (const std::size_t m : chosen) values.push_back(row.scores.values[m]);
    row.scores.values = std::move(values);
  }
  return file;
}

ScoreFile scores_of(const py::dict& columns, const std::optional<std::vector<std::string>>& metrics,
                    const ScoreColumns& directions) {
  const Table table = table_from(columns);
  for (const char* needed : {"item", "model"})
    if (std::ranges::find(table.columns, needed) == table.columns.end())
      throw py::value_error(fmt::format("table must have a column '{}'", needed));
  if (names_of_scores(table, directions).empty())
    throw py::value_error(
        "table must have a column that is a metric of the program, or is named in higher_is_better or "
        "lower_is_better");
  ScoreFile file = scores_from(table, directions);
  return metrics ? only(std::move(file), *metrics) : file;
}

// The tables, each worked out when it is asked for.
class TablesOf {
 public:
  TablesOf(const py::dict& columns, const std::optional<std::vector<std::string>>& metrics,
           std::vector<std::string> higher, std::vector<std::string> lower, const std::string& unit,
           py::handle seed, py::handle threads)
      : scores_(scores_of(columns, metrics, {std::move(higher), std::move(lower)})),
        threads_(static_cast<int>(whole_number({threads, "threads"}, 1, kMostThreads))) {
    StatisticsOptions options;
    if (!parse_option(unit, options.unit))
      throw py::value_error(fmt::format("unit must be {}, not '{}'", expected_of<Observation>(), unit));
    const std::uint64_t number = whole_number({seed, "seed"}, 0, UINT64_MAX);
    conclusions_ =
        computed(threads_, [&] { return conclude(scores_.rows, scores_.metrics, options, number); });
  }

  std::string table(const std::string& name) const {
    return computed(threads_, [&] { return to_csv(table_of(name)); });
  }

 private:
  Table table_of(const std::string& name) const {
    if (name == "summary") return summary_table(conclusions_);
    if (name == "ranking") return ranking_table(conclusions_);
    if (name == "significance") return significance_table(conclusions_);
    if (name == "ranking_agreement") return agreement_table(conclusions_);
    if (name == "human_share") return human_share_table(conclusions_);
    if (name == "per_class") return per_class_table(scores_.rows, conclusions_.metrics, conclusions_.unit);
    if (name == "power") return power_table(conclusions_);
    throw std::logic_error("no table of conclusions is called " + name);
  }

  ScoreFile scores_;
  int threads_;
  Conclusions conclusions_;
};

}  // namespace

void bind_stats(py::module_& module) {
  py::class_<TablesOf>(module, "Conclusions")
      .def(py::init<const py::dict&, const std::optional<std::vector<std::string>>&, std::vector<std::string>,
                    std::vector<std::string>, const std::string&, py::handle, py::handle>())
      .def("table", &TablesOf::table);
}

}  // namespace salbench::python
