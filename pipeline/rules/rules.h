// SPDX-License-Identifier: GPL-3.0-or-later
// This folder: the rules, and THE table of them: everything there is to compute for a data set, from what,
// and how, in the order of the paper's pipeline: load, scan, normals, descriptors, models, histogram
// matching, metrics. A configuration and the inputs come in; the engine's rules go out. It includes the
// engine, inputs/, config/ and the stages, and knows no flow graph and no table of results.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/engine/plan.h"
#include "pipeline/inputs/front.h"
#include "pipeline/inputs/inputs.h"
#include "pipeline/rules/config.h"
#include "pipeline/rules/values.h"

namespace salbench {

// There are rules for what the data set has and the configuration asks for; point clouds are always
// evaluated. A reference histogram that is given takes the place of the data set's own mean. Throws
// ConfigError where maps are given of no shape.
Rules make_rules(const Config& config, const Inputs& inputs = {},
                 const std::optional<Histogram>& given_reference = {}, const Front& front = {});

// All that a run of the configuration over the inputs has to compute.
Project make_project(const Config& config, const Inputs& inputs,
                     const std::optional<Histogram>& given_reference = {}, const Front& front = {});

std::string node_name(const Rule& rule);  // "fpfh of scans": levels may have stages of one name

}  // namespace salbench
