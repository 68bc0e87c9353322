// SPDX-License-Identifier: GPL-3.0-or-later
// Scores by unit of inference. The one place that decides what counts as one observation, and which shapes
// models are compared on: every table, interval and test reads its scores here.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/results/results.h"
#include "stages/stats/resampling.h"
#include "stages/stats/unit.h"

namespace salbench {

// Scores of some models on the same units, without gaps.
struct UnitScores {
  std::vector<std::size_t> models;  // columns, as DatasetScores numbers them
  std::vector<std::size_t> units;   // rows, likewise
  Columns scores;                   // units x models: means over the shapes of a unit
  std::int64_t n_shapes = 0;        // shapes in them

  // That after the last for a model that is not among them.
  std::size_t column_of(std::size_t model) const {
    return static_cast<std::size_t>(std::ranges::find(models, model) - models.begin());
  }
};

// The scores of one data set, or of one class or one split of it. Keeps references to the rows.
class DatasetScores {
 public:
  DatasetScores(const std::vector<ResultRow>& rows, std::string_view dataset, Observation unit,
                std::string_view only_class = {}, std::string_view only_split = {});

  const std::string& dataset() const { return dataset_; }
  // First cells of a row of a table: the data set and, where items are in splits, the one that all of these
  // are in, empty for several.
  std::vector<Cell> label() const;
  bool in_splits() const { return in_splits_; }
  const std::vector<std::string>& models() const { return models_; }  // in the order of their first row
  bool is_reference(std::size_t model) const { return is_reference_[model]; }
  // Number of a model by its name; that after the last if there is none.
  std::size_t find(std::string_view model) const {
    return static_cast<std::size_t>(std::ranges::find(models_, model) - models_.begin());
  }

  // Models with at least one score of the metric: all of them, and the competitors among them.
  std::vector<std::size_t> scored(std::size_t metric) const;
  std::vector<std::size_t> competitors(std::size_t metric) const;

  // Scores of some models on the shapes that they and all competitors have a score for. So all means, tests
  // and ranks are about the same shapes, and a model gains nothing by failing on hard ones. References may
  // have fewer: they bound nobody else's shapes.
  UnitScores compared(std::size_t metric, std::span<const std::size_t> models) const;
  // Scores of some models on the shapes that they and those of `required` have a score for.
  UnitScores averaged(std::size_t metric, std::span<const std::size_t> models,
                      std::span<const std::size_t> required) const;
  // Scores of one model on all shapes that it has a score for.
  UnitScores own(std::size_t metric, std::size_t model) const;

  std::vector<std::size_t> units_of_shapes() const;  // [shape]
  // One value per shape, NaN where the model has no score: the paper's reading.
  std::vector<double> by_shape(std::size_t metric, std::size_t model) const;

 private:
  struct Shape {
    std::string item, view;
    std::size_t unit;
    std::vector<const ResultRow*> rows;  // [model]; null where there is none
  };

  double value(const Shape& shape, std::size_t metric, std::size_t model) const;

  std::string dataset_, split_;
  bool in_splits_ = false;
  std::vector<std::string> models_;
  std::vector<bool> is_reference_;
  std::vector<Shape> shapes_;
  std::size_t n_units_ = 0;
};

}  // namespace salbench
