// SPDX-License-Identifier: GPL-3.0-or-later
// Rules from recordings of gaze to ground truth: fixations, where these are on the shape, how densely people
// looked. Each is a stage of its own, so that what is asked most, such as how wide a fixation is spread,
// costs least to try.
#pragma once

#include <string>

#include "pipeline/rules/config.h"
#include "pipeline/rules/shapes.h"

namespace salbench {

// Whether the ground truth is made of recordings: where the configuration asks for it, or a data set has
// nothing else. Throws ConfigError where it asks and there is none.
bool is_from_gaze(const Config& config, const Inputs& inputs);

// How the ground truth was made of recordings: stages with their versions and options, on one line of YAML.
std::string gaze_recipe(const GazeOptions& options);

// By face, if faces are scored.
Output<GroundTruth> add_gaze_truth(RuleTable& table, const Config& config, const Source& source,
                                   const Output<Mesh>& mesh, const Output<ShapeInForm>& form);
// On the partial mesh of a cloud.
Output<GroundTruth> add_gaze_truth(RuleTable& table, const Config& config, const Source& source,
                                   const Output<PointCloud>& cloud, const Output<Surface>& surface,
                                   const Output<ShapeInForm>& form);

}  // namespace salbench
