// SPDX-License-Identifier: GPL-3.0-or-later
// Maps and scores of a run that has ended. Nothing here is stored.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/run/session.h"

namespace salbench::python {

// Models that make maps, in the order of the tables.
std::vector<std::string> models_with_maps(const Project& project);

// Shapes that have maps, if no model failed on them.
std::vector<std::string> shapes_with_maps(const Project& project);

// Shapes of which a model has a map, in the order of the data set.
std::vector<std::string> mapped_items(const Session& session, const std::string& model);

// The map of a model, or nothing if there is none of this shape.
ValuePtr map_of(Session& session, const std::string& model, const std::string& item);

// Number of points of a shape of the run; nothing for a name that no shape has.
std::optional<std::size_t> point_count(Session& session, const std::string& item);

// Scores of a map of a shape by the metrics of the run; without a name those of the model whose map it is, or
// of the first. The map has a value per point. Throws InputError where the run has no scores of the shape, or
// the map is not finite.
Scores scores_of(Session& session, const ScalarField& map, const std::string& item, std::string model);

}  // namespace salbench::python
