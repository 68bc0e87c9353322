// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of human performance. HS has no map: its scores come from the participants, who saw meshes only.
#pragma once

#include "pipeline/catalog/config.h"
#include "pipeline/catalog/models.h"
#include "pipeline/catalog/row.h"

namespace salbench {

// Adds the scores of HS and its curve over the number of participants, for the meshes whose files tell them
// apart.
void add_human_performance(Catalog& catalog, const ShapeRows& meshes, const RowOf<Mesh>& mesh,
                           const Config& config, const Model& model);

}  // namespace salbench
