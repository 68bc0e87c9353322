// SPDX-License-Identifier: GPL-3.0-or-later
// This folder: the rules, in THE table of everything that can be computed for a data set, with inputs and
// functions, in the order of the paper's pipeline: load, scan, normals, descriptors, models, histogram
// matching, metrics. A configuration and the inputs come in; the engine's rules go out. It includes the
// engine, inputs/, config/ and the stages, but neither the flow graph nor result tables.
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

// Rules for the shapes of the data set and the outputs requested by the configuration; point clouds are
// always evaluated. A given reference histogram replaces the data set's own mean. Throws ConfigError if given
// maps match no shape.
Rules make_rules(const Config& config, const Inputs& inputs = {},
                 const std::optional<Histogram>& given_reference = {}, const Front& front = {});

// Everything to compute for the configuration and inputs.
Project make_project(const Config& config, const Inputs& inputs,
                     const std::optional<Histogram>& given_reference = {}, const Front& front = {});

std::string node_name(const Rule& rule);  // "fpfh of scans": stages of different levels may share a name

}  // namespace salbench
