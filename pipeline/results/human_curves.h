// SPDX-License-Identifier: GPL-3.0-or-later
// Human curves: how well n participants predict n others, what more of them add, how many of them a model is
// worth, and how reliable the ground truth is that they make. Within a mesh, since hard meshes are hard for
// any number of people. [tasse2016]
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/table.h"
#include "pipeline/results/conclusions.h"
#include "pipeline/results/raw_tables.h"
#include "pipeline/results/results.h"

namespace salbench {

// The tables of these names, whose columns are those of docs/data_dictionary.md.
Table human_curve_table(const std::vector<MeshCurve>& curves, const Metrics& metrics);
Table human_curve_by_mesh_table(const std::vector<MeshCurve>& curves, const Metrics& metrics);
Table human_curve_differences_table(const std::vector<MeshCurve>& curves, const Metrics& metrics,
                                    Observation unit);
Table human_reliability_table(const std::vector<MeshCurve>& curves, const Metrics& metrics, Observation unit);

// How many participants a model is worth: where the mean human curve first is as good as the model's mean on
// the same meshes. The curve is used up to the largest group that at least half of the meshes have, over the
// meshes that have it.
Table human_equivalents_table(const std::vector<MeshCurve>& curves, const std::vector<ResultRow>& rows,
                              const Conclusions& conclusions);

// All of them, as CSV files, each below `head`; without curves, those of an earlier run are removed. Throws
// StorageError.
void write_human_curves(const std::filesystem::path& folder, const std::vector<MeshCurve>& curves,
                        const std::vector<ResultRow>& rows, const Conclusions& conclusions,
                        const std::string& head);

}  // namespace salbench
