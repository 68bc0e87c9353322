// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/results/unit_scores.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "pipeline/results/raw_tables.h"
#include "pipeline/rules/models.h"

namespace salbench {
namespace {

// Number of a key, given out in the order of first use.
template <class Key>
std::size_t number_of(std::map<Key, std::size_t>& numbers, Key key) {
  const std::size_t next = numbers.size();
  return numbers.emplace(std::move(key), next).first->second;
}

std::string unit_name(const ResultRow& row, Observation unit) {
  if (unit == Observation::mesh) return row.item;
  return unit == Observation::item_class ? row.category : row.item + "/" + row.view;
}

}  // namespace

DatasetScores::DatasetScores(const std::vector<ResultRow>& rows, std::string_view dataset, Observation unit,
                             std::string_view only_class, std::string_view only_split)
    : dataset_(dataset), in_splits_(any_in_splits(rows)) {
  if (splits_among(rows, dataset).empty())
    for (const ResultRow& row : rows)
      if (row.dataset == dataset) split_ = row.split;
  if (!only_split.empty()) split_ = only_split;
  std::map<std::string, std::size_t> models, units;
  std::map<std::pair<std::string, std::string>, std::size_t> shapes;
  for (const ResultRow& row : rows) {
    // A shape without a class is no unit of them.
    if (row.dataset != dataset || (unit == Observation::item_class && row.category.empty())) continue;
    if (!only_class.empty() && row.category != only_class) continue;
    if (!only_split.empty() && row.split != only_split) continue;
    const std::size_t model = number_of(models, row.model);
    if (model == models_.size()) {
      models_.push_back(row.model);
      is_reference_.push_back(is_reference_model(row.model));
    }
    const std::size_t shape = number_of(shapes, {row.item, row.view});
    if (shape == shapes_.size())
      shapes_.push_back({row.item, row.view, number_of(units, unit_name(row, unit)), {}});
    shapes_[shape].rows.resize(std::max(shapes_[shape].rows.size(), model + 1), nullptr);
    shapes_[shape].rows[model] = &row;
  }
  n_units_ = units.size();
}

std::vector<Cell> DatasetScores::label() const {
  std::vector<Cell> cells = {dataset_};
  if (in_splits_) cells.emplace_back(split_);
  return cells;
}

double DatasetScores::value(const Shape& shape, std::size_t metric, std::size_t model) const {
  const ResultRow* row = model < shape.rows.size() ? shape.rows[model] : nullptr;
  return row == nullptr ? std::numeric_limits<double>::quiet_NaN() : row->value(metric);
}

std::vector<std::size_t> DatasetScores::units_of_shapes() const {
  std::vector<std::size_t> units;
  for (const Shape& shape : shapes_) units.push_back(shape.unit);
  return units;
}

std::vector<double> DatasetScores::by_shape(std::size_t metric, std::size_t model) const {
  std::vector<double> values;
  for (const Shape& shape : shapes_) values.push_back(value(shape, metric, model));
  return values;
}

std::vector<std::size_t> DatasetScores::scored(std::size_t metric) const {
  std::vector<std::size_t> found;
  for (std::size_t model = 0; model < models_.size(); ++model)
    if (std::ranges::any_of(shapes_,
                            [&](const Shape& shape) { return !std::isnan(value(shape, metric, model)); }))
      found.push_back(model);
  return found;
}

std::vector<std::size_t> DatasetScores::competitors(std::size_t metric) const {
  std::vector<std::size_t> found = scored(metric);
  std::erase_if(found, [&](std::size_t model) { return is_reference(model); });
  return found;
}

UnitScores DatasetScores::averaged(std::size_t metric, std::span<const std::size_t> models,
                                   std::span<const std::size_t> required) const {
  const std::size_t k = models.size();
  if (k == 0) return {};
  std::vector<std::int64_t> counts(n_units_, 0);
  std::vector<double> sums(n_units_ * k, 0.0);
  UnitScores result{{models.begin(), models.end()}, {}, {k, {}}};
  const auto has = [&](const Shape& shape) {
    return [&, metric](std::size_t model) { return !std::isnan(value(shape, metric, model)); };
  };
  for (const Shape& shape : shapes_) {
    if (!std::ranges::all_of(required, has(shape)) || !std::ranges::all_of(models, has(shape))) continue;
    ++counts[shape.unit];
    ++result.n_shapes;
    for (std::size_t m = 0; m < k; ++m) sums[shape.unit * k + m] += value(shape, metric, models[m]);
  }
  for (std::size_t unit = 0; unit < n_units_; ++unit) {
    if (counts[unit] == 0) continue;
    result.units.push_back(unit);
    for (std::size_t m = 0; m < k; ++m)
      result.scores.values.push_back(sums[unit * k + m] / static_cast<double>(counts[unit]));
  }
  return result;
}

UnitScores DatasetScores::compared(std::size_t metric, std::span<const std::size_t> models) const {
  return averaged(metric, models, competitors(metric));
}

UnitScores DatasetScores::own(std::size_t metric, std::size_t model) const {
  return averaged(metric, {&model, 1}, {});
}

}  // namespace salbench
