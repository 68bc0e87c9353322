// SPDX-License-Identifier: GPL-3.0-or-later
// The table of models and metrics that goes into a paper: mean, half interval, group, and who failed where.
#pragma once

#include "pipeline/results/conclusions.h"

namespace salbench {

// Student's interval of a mean, cut at the values that the metric can take. The true mean lies within these,
// so that the cut interval holds it as often as the whole one. `mean` itself always stays inside.
Interval interval_within_range(const Summary& summary, const std::string& metric);

// compact.csv (docs/data_dictionary.md): a row per data set, metric and model with scores; competitors by
// rank, then references.
Table compact_table(const Conclusions& conclusions);

}  // namespace salbench
