// SPDX-License-Identifier: GPL-3.0-or-later
// Scores of a map by some metrics.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

#include "stages/core/rng.h"
#include "stages/core/types.h"
#include "stages/metrics/measure.h"
#include "stages/metrics/metrics.h"

namespace salbench {

// The map as metrics read it without histogram matching: min-max-normalised, unless the matching is raw or
// shifted. NaN counts as 0. Throws InputError for a value below 0 if raw, and for an infinite one.
ScalarField unmatched(std::span<const double> map, Matching reading);

// Properties of a shape of n points that these metrics need. `points` and `surface` may be empty if no metric
// needs them.
Measures measures_of(std::span<const Metric> metrics, std::size_t n, Points points, Surface surface,
                     ScalarField negatives = {});

// Values of the metrics for one map, in their order; NaN where ground truth or measures are missing. Points
// whose saliency is NaN (unseen) are excluded with their values and picks. A constant map counts as 0.5
// everywhere. Throws InputError if the ground truth does not fit the shape: picks out of range, or a
// different number of points; and for other values that are not finite. Every metric reads the random numbers
// from the beginning.
Scores score(std::span<const Metric> metrics, std::span<const double> map, const GroundTruth& truth,
             const MetricsOptions& options, const Rng& rng, const Measures& measures);
// Metrics named in the options, for a shape without further properties.
Scores score(const ScalarField& map, const GroundTruth& truth, const MetricsOptions& options, const Rng& rng);

// Clips values that rounding puts outside of their range, such as a correlation of 1 + 2e-16. Stored scores
// are not clipped; displayed ones are.
Scores in_range(std::span<const Metric> metrics, Scores scores);

// Score of a constant map; nullopt if it varies between shapes.
std::optional<double> score_of_constant(const Metric& metric, const MetricsOptions& options);

// Value of one of the metrics named in the options. Throws std::out_of_range for another one.
double value_of(const Scores& scores, std::string_view metric, const MetricsOptions& options = {});

}  // namespace salbench
