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

// The map as metrics read it where no histogram is matched: min-max-normalised, unless the reading is raw or
// shifted. NaN counts as 0. Throws InputError for a value below 0 that is read raw, and for an infinite one.
ScalarField unmatched(std::span<const double> map, Matching reading);

// The facts that these metrics need of a shape of n points. `points` and `surface` may be empty if no metric
// needs them.
Measures measures_of(std::span<const Metric> metrics, std::size_t n, Points points, Surface surface,
                     ScalarField negatives = {});

// The metrics of one map, in their order. What the ground truth or the measures have nothing for is NaN.
// Points whose saliency is NaN, which nobody saw, take no part: neither their values nor picks there. A
// constant map counts as 0.5 everywhere, whichever constant it is. Throws InputError where the ground truth
// is not of this shape: picks out of range, or another number of points; and for other values that are not
// finite. Every metric reads the random numbers from their beginning.
Scores score(std::span<const Metric> metrics, std::span<const double> map, const GroundTruth& truth,
             const MetricsOptions& options, const Rng& rng, const Measures& measures);
// Metrics that the options name, of a shape of which nothing else is known.
Scores score(const ScalarField& map, const GroundTruth& truth, const MetricsOptions& options, const Rng& rng);

// Rounding can put a value beyond what it can be, such as a correlation of 1 + 2e-16. Stored scores keep it;
// what is shown does not.
Scores in_range(std::span<const Metric> metrics, Scores scores);

// Score of a constant map; nothing where it differs from shape to shape.
std::optional<double> score_of_constant(const Metric& metric, const MetricsOptions& options);

// Value of one metric of those that the options name. Throws std::out_of_range for another one.
double value_of(const Scores& scores, std::string_view metric, const MetricsOptions& options = {});

}  // namespace salbench
