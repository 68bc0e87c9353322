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
#include "pipeline/results/results.h"

namespace salbench {

struct MeshCurve {
  std::string item, category;
  HumanCurve curve;
};

// Those of the meshes that HS was computed for, in their order.
std::vector<MeshCurve> collect_human_curves(const RunState& run);

// n, metric, n_meshes, mean, sd, ci95_low, ci95_high (Student): how well n people predict n others, over the
// meshes that have 2n participants; n_meshes counts those where the metric is defined.
Table human_curve_table(const std::vector<MeshCurve>& curves, const Metrics& metrics);

// item, class, n, metric, value, reliability: the curve of each mesh; of cc also the reliability of the
// ground truth that 2n people make, 2r / (1 + r) of the correlation r of two halves, 0 where they do not
// agree. [spearman1910] [brown1910]
Table human_curve_by_mesh_table(const std::vector<MeshCurve>& curves, const Metrics& metrics);

// metric, from_participants, to_participants, n (units), n_shapes, mean_difference, ci95_low, ci95_high, t_p,
// ci90_low, ci90_high: what more participants add, the value for more less that for fewer, over the meshes
// that have both; each number of participants with every larger one. Paired, as in significance_table.
Table human_curve_differences_table(const std::vector<MeshCurve>& curves, const Metrics& metrics,
                                    Observation unit);

// dataset, metric, model, n (units), n_shapes, largest_group, mean, k, ci95_low, ci95_high, k_bound,
// low_bound, high_bound, crossings, remark: how many participants a model is worth, which is where the mean
// human curve first is as good as the model's mean on the same meshes. k and the ends of its interval are
// empty where they are beyond the curve, and their bounds say "<1" or ">11". The curve is used up to the
// largest group that at least half of the meshes have, over the meshes that have it; `remark` says why there
// is no number.
Table human_equivalents_table(const std::vector<MeshCurve>& curves, const std::vector<ResultRow>& rows,
                              const Conclusions& conclusions);

// metric, n (units), n_shapes, fewest_participants, most_participants, split_half, mean, sd, ci95_low,
// ci95_high (Student): the reliability of the ground truth by the largest groups of each mesh. Empty where cc
// is not computed.
Table human_reliability_table(const std::vector<MeshCurve>& curves, const Metrics& metrics, Observation unit);

// human_curve.csv, human_curve_by_mesh.csv, human_curve_differences.csv, human_equivalents.csv and
// human_reliability.csv, each below `head`; without curves, those of an earlier run are removed. Throws
// StorageError.
void write_human_curves(const std::filesystem::path& folder, const std::vector<MeshCurve>& curves,
                        const std::vector<ResultRow>& rows, const Conclusions& conclusions,
                        const std::string& head);

}  // namespace salbench
