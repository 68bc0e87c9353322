// SPDX-License-Identifier: GPL-3.0-or-later
// Metrics that do not tell models from chance: by their means, random values or a constant map are as good.
#pragma once

#include <string>
#include <vector>

#include "pipeline/results/results.h"
#include "stages/stats/unit.h"

namespace salbench {

struct ChanceRemark {
  std::string dataset, metric;
  std::string text;  // one line: which reference is level with or ahead of which models, and by how much
};

// One per data set and metric by whose means chance (RS) or the constant map, as far as the rows have them,
// is level with or ahead of a model or of people; over the shapes and units of the other tables.
std::vector<ChanceRemark> chance_remarks(const std::vector<ResultRow>& rows, const Metrics& metrics,
                                         Observation unit);

}  // namespace salbench
