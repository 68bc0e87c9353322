// SPDX-License-Identifier: GPL-3.0-or-later
// Ground truth transferred to other points: from faces or other samples to the vertices of a mesh, and from a
// mesh to one of its scans. NaN stands for unseen, in input and result.
#pragma once

#include <span>

#include "stages/core/types.h"

namespace salbench {

// Area-weighted mean over the seen faces around each vertex; NaN if there are none with an area. `values`: f.
// Throws InputError for another number of values, and for unusable values.
ScalarField vertex_values_of_faces(Points vertices, Surface faces, std::span<const double> values);

// Value of the nearest sample; NaN if it is farther than `max_distance` (length unit of the mesh). Among
// equally near samples, the first. `values`: one per sample, at least one.
ScalarField vertex_values_of_samples(Points vertices, Points samples, std::span<const double> values,
                                     double max_distance);

// A scan point takes the saliency of the nearest mesh vertex. A pick is kept if some scan point has the
// picked vertex as its nearest; it then moves to the first such point, once per participant. Participants
// whose picks are all hidden remain, without picks. Saliency is empty if the mesh has none. Throws InputError
// if the ground truth does not fit the mesh. [tasse2016]
GroundTruth scan_ground_truth(const Scan& scan, const Mesh& mesh, const GroundTruth& mesh_truth);

}  // namespace salbench
