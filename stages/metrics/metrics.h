// SPDX-License-Identifier: GPL-3.0-or-later
// The table of metrics: agreement of a saliency map with human marks. [tasse2016]
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "stages/core/rng.h"
#include "stages/metrics/comparison.h"
#include "stages/metrics/options.h"

namespace salbench {

// Inputs of a metric.
struct MetricInput {
  std::span<const double> map;           // n, finite, in the form that the metric reads
  std::span<const std::int32_t> picked;  // ascending; each once, or as often as it was picked
  const MetricsOptions& options;
  Rng rng;                       // a metric draws from its own copy, so all metrics see the same stream
  Matching matching;             // form of the map
  const Comparison& comparison;  // map and saliency
};

// Weight of a point that several participants picked, or one of them repeatedly.
enum class PickCount : std::uint8_t { once, multiplicity };

// Property of the shape that a metric needs besides the map and the ground truth.
enum class Reads : std::uint8_t {
  nothing,
  positions,          // points
  areas,              // around them
  surface_distances,  // along edges
  other_shapes        // ground truth of the other shapes in the set, by distance from the centroid
};

struct Metric {
  std::string name = {};   // column of results.csv
  std::string label = {};  // label for people
  std::string unit = "1";
  std::string help = {};
  double (*value)(const MetricInput&) = nullptr;  // NaN where undefined
  Range range = {};                               // possible values
  std::int32_t since = 1;  // version of the stage `scores` that introduced these values
  bool higher_is_better = true;
  PickCount picks = PickCount::once;
  Matching matching = Matching::histogram;  // default
  Reads reads = Reads::nothing;
  bool constant_varies = false;  // the score of a constant map varies between shapes
};

// A new metric is a function and a row. A metric whose values change takes the next number in the table as
// its `since`; a new one starts at 1, since keys name the metrics chosen.
std::span<const Metric> metric_table();

// Metrics named in the options, with the matching chosen there, in the order of the table. Throws OptionError
// for an unknown name.
std::vector<Metric> chosen_metrics(const MetricsOptions& options);

// Version of the stage `scores` for these metrics: the largest `since`, and at least 3 if one of them reads
// maps without matching. Metrics with a floor that read maps as computed have 5 as their `since`: they once
// had the floor, which is meant for maps in [0, 1].
std::int32_t scores_version(std::span<const Metric> metrics);

bool any_reads(std::span<const Metric> metrics, Reads what);
bool any_of_points(std::span<const Metric> metrics);  // reads the positions of the points
bool any_of_faces(std::span<const Metric> metrics);

}  // namespace salbench
