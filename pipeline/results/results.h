// SPDX-License-Identifier: GPL-3.0-or-later
// This folder: results. A run comes in, as a Resolver that knows every value. Tables of its scores go out, of
// which the Python package concludes, and the record of the run (record.h).
// It includes rules/ and all before it, computes no job itself, and prints nothing.
//
// This file: scores of a run, item by item. tables.h writes them.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/engine/resolver.h"
#include "pipeline/rules/rules.h"
#include "stages/metrics/metrics.h"

namespace salbench {

using Metrics = std::vector<Metric>;

struct ResultRow {
  std::string dataset;  // "meshes", "scans" or "clouds"
  std::string item;     // the mesh or point cloud
  std::string category;
  std::string view;  // of a scan; empty for others
  std::string model;
  Scores scores;
  Job job = {};            // that gave them
  std::string split = {};  // of the data set; empty if it has none

  // Score by one of the metrics that the scores hold.
  double value(std::size_t metric) const { return scores.values.at(metric); }
};

// A run, as its results are read from it.
struct RunState {
  const Config& config;
  const Inputs& inputs;
  Resolver& resolver;

  const Project& project() const { return resolver.project(); }
  const Units& units() const { return project().units; }
  const Decision& decision(const Job& job) const { return resolver.plan()[job]; }
  std::vector<Unit> shapes() const;         // for which there are rules, family by family
  std::vector<Job> known(Role role) const;  // those of the rules of this role whose result is
};

// Of the shape of a unit, as tables have it: empty but for scans and views that are scored by themselves.
std::string view_of(const Units& units, Unit unit);

// One row per item and model that was scored; by item, mesh before scans, then in the order of the models.
// Read from the tables of scores, or for those that are still open from the scores that there are.
std::vector<ResultRow> collect_results(const RunState& run);

// Likewise of the maps after the k-th number of smoothing steps that the metrics have.
std::vector<ResultRow> collect_smoothed(const RunState& run, std::size_t k);

// Likewise of a constant map, by the metrics that score it otherwise on each shape.
std::vector<ResultRow> collect_constant(const RunState& run);

// For people: what maps were matched to. whose: "run", or "export" where it is one.
std::string reference_text(const RunState& run, std::string_view whose);

// For people: a sentence for each model that was trained on shapes which it is scored on.
std::vector<std::string> training_remarks(const RunState& run);

}  // namespace salbench
