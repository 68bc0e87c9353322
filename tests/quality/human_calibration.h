// SPDX-License-Identifier: GPL-3.0-or-later
// How often the intervals hold that compare models with people, over simulated meshes whose scores and human
// curves have the means and covariances of a run's.
#pragma once

#include <filesystem>

#include "pipeline/results/score_file.h"
#include "tests/quality/calibration.h"

namespace salbench {

struct PeopleModel {
  Metric metric;
  std::vector<std::string> models;  // the first columns; the others are the curve at 1, 2, ...
  Columns values;                   // meshes x columns
};

// Of the meshes that all models have a score for and that have the longest curve. No models where there are
// fewer than two such meshes, or none of HS and RS.
PeopleModel people_model(const ScoreFile& scores, const std::filesystem::path& curve_by_mesh,
                         std::size_t metric);

// The truth is what the means say. Shares and places are counted where it is a number.
std::vector<Rate> calibrate_people(const PeopleModel& model, std::size_t meshes, std::size_t data_sets,
                                   std::uint64_t seed);

}  // namespace salbench
