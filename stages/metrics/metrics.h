// SPDX-License-Identifier: GPL-3.0-or-later
// The table of metrics: agreement of a saliency map with what people marked. [tasse2016]
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
  std::span<const double> saliency;      // n, min-max-normalised; empty where not known
  const MetricsOptions& options;
  Rng rng;                       // a metric draws from its own copy, so all metrics see the same stream
  Matching matching;             // form of the map
  const Comparison& comparison;  // of map and saliency
};

// Weight of a point that several participants picked, or one of them repeatedly.
enum class PickCount : std::uint8_t { once, multiplicity };

// A fact of the shape that a metric needs beside the map and the ground truth.
enum class Reads : std::uint8_t {
  nothing,
  positions,          // of the points
  areas,              // around them
  surface_distances,  // along edges
  other_shapes        // ground truth of the others in the set, by the distance from the centroid
};

struct Metric {
  std::string name = {};   // column of results.csv
  std::string label = {};  // the same for people
  std::string unit = "1";
  std::string help = {};
  double (*value)(const MetricInput&) = nullptr;  // NaN where undefined
  Range range = {};                               // what the value can be at all
  std::int32_t since = 1;  // version of the stage `scores` with which these values came
  bool higher_is_better = true;
  PickCount picks = PickCount::once;
  Matching matching = Matching::histogram;  // unless the options say otherwise
  Reads reads = Reads::nothing;
  bool constant_varies = false;  // the score of a constant map differs from shape to shape
};

// A new metric is a function and a row. A metric whose values change takes the next number in the table as
// its `since`; a new one starts at 1, since keys name the metrics chosen.
std::span<const Metric> metric_table();

// Metrics that the options name, with the matching that these choose, in the order of the table. Throws
// OptionError for a name that is not in it.
std::vector<Metric> chosen_metrics(const MetricsOptions& options);

// Version of the stage `scores` for these metrics: the largest `since`, and at least 3 where one of them
// reads maps without matching. With a floor, those that read maps as they are made have 5 as their `since`:
// they had the floor once, which is of maps in [0, 1].
std::int32_t scores_version(std::span<const Metric> metrics);

bool any_reads(std::span<const Metric> metrics, Reads what);
bool any_of_points(std::span<const Metric> metrics);  // reads where the points are
bool any_of_faces(std::span<const Metric> metrics);

}  // namespace salbench
