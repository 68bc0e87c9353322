// SPDX-License-Identifier: GPL-3.0-or-later
// Rules of human performance (HS). HS has no map: its scores compare participants, who saw meshes only.
#pragma once

#include "pipeline/rules/config.h"

namespace salbench {

// Adds the scores of HS, and its curve over the number of participants, for meshes with participants told
// apart.
Output<Scores> add_human_performance(RuleTable& table, const ShapeOutputs& meshes, const Output<Mesh>& mesh,
                                     const Units& units, const Config& config, const Model& model);

}  // namespace salbench
