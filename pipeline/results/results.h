// SPDX-License-Identifier: GPL-3.0-or-later
// This folder: results. A run comes in, as a Resolver that knows every value. Score tables, from which the
// Python package draws conclusions, and the run's record (record.h) go out.
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
  std::string view;  // view of a scan; empty for others
  std::string model;
  Scores scores;
  Job job = {};            // source of the scores
  std::string split = {};  // split in the data set; may be empty

  // Score by index into the metrics of the scores.
  double value(std::size_t metric) const { return scores.values.at(metric); }
};

// A run, as seen by its results.
struct RunState {
  const Config& config;
  const Inputs& inputs;
  Resolver& resolver;

  const Project& project() const { return resolver.project(); }
  const Units& units() const { return project().units; }
  const Decision& decision(const Job& job) const { return resolver.plan()[job]; }
  std::vector<Unit> shapes() const;         // shapes with rules, family by family
  std::vector<Job> known(Role role) const;  // jobs of this role with a result
};

// View of a unit's shape in tables: empty except for scans and separately scored views.
std::string view_of(const Units& units, Unit unit);

// One row per scored item and model; ordered by item, mesh before scans, then by the configuration's models.
// Read from score tables, or from single scores while a table is open.
std::vector<ResultRow> collect_results(const RunState& run);

// The same for maps after the k-th smoothing step of the metrics.
std::vector<ResultRow> collect_smoothed(const RunState& run, std::size_t k);

// The same for a constant map, by the metrics whose score of it varies between shapes.
std::vector<ResultRow> collect_constant(const RunState& run);

// Sentence on the reference that maps were matched to. whose: "run" or "export".
std::string reference_text(const RunState& run, std::string_view whose);

// One sentence per model that is scored on shapes of its training set.
std::vector<std::string> training_remarks(const RunState& run);

}  // namespace salbench
