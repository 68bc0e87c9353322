// SPDX-License-Identifier: GPL-3.0-or-later
// Rules from gaze recordings to ground truth: fixations, their positions on the shape, gaze density. Each is
// a stage of its own, so that the parameters varied most, such as the spread of a fixation, are cheapest to
// change.
#pragma once

#include <string>

#include "pipeline/rules/config.h"
#include "pipeline/rules/shapes.h"

namespace salbench {

// True if ground truth comes from recordings: requested by the configuration, or the only kind in the data
// set. Throws ConfigError if requested but there are none.
bool is_from_gaze(const Config& config, const Inputs& inputs);

// Recipe of ground truth from recordings: stages with versions and options, one line of YAML.
std::string gaze_recipe(const GazeOptions& options);

// Per face if faces are scored.
Output<GroundTruth> add_gaze_truth(RuleTable& table, const Config& config, const Source& source,
                                   const Output<Mesh>& mesh, const Output<ShapeInForm>& form);
// On the partial mesh of a cloud.
Output<GroundTruth> add_gaze_truth(RuleTable& table, const Config& config, const Source& source,
                                   const Output<PointCloud>& cloud, const Output<Surface>& surface,
                                   const Output<ShapeInForm>& form);

}  // namespace salbench
