// SPDX-License-Identifier: GPL-3.0-or-later
// Maps and scores of a finished run. Nothing is stored.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/run/session.h"

namespace salbench::python {

// Models that compute maps, in the order of the tables.
std::vector<std::string> models_with_maps(const Project& project);

// Shapes that have maps unless a model failed on them.
std::vector<std::string> shapes_with_maps(const Project& project);

// Shapes with a map of the model, in the order of the data set.
std::vector<std::string> mapped_items(const Session& session, const std::string& model);

// Map of a model; null if it has none of this shape.
ValuePtr map_of(Session& session, const std::string& model, const std::string& item);

// Number of points of a shape in the run; nullopt for an unknown name.
std::optional<std::size_t> point_count(Session& session, const std::string& item);

// Scores of a shape's map by the metrics of the run, as if computed by `model`; if empty, by the model whose
// map it is, or the first. The map has one value per point. Throws InputError if the run does not score the
// shape, or if the map is not finite.
Scores scores_of(Session& session, const ScalarField& map, const std::string& item, std::string model);

}  // namespace salbench::python
