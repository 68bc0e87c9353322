// SPDX-License-Identifier: GPL-3.0-or-later
// Ground truth carried over to other points: what was measured per face, or at other points than the
// vertices, to the vertices of a mesh; that of a mesh to one scan of it. NaN stands for what was not seen, in
// the values as in the result.
#pragma once

#include <span>

#include "stages/core/types.h"

namespace salbench {

// The mean over the faces around each vertex, weighted by their areas; NaN where no face with an area was
// seen. `values`: f. Throws InputError for another number of values, and
// for values that cannot be computed with.
ScalarField vertex_values_of_faces(Points vertices, Surface faces, std::span<const double> values);

// The value of the nearest sample; NaN farther than `max_distance` (length unit of the mesh) from all. Of
// equally near samples the first counts. `values`: one per sample, of which there is one at least.
ScalarField vertex_values_of_samples(Points vertices, Points samples, std::span<const double> values,
                                     double max_distance);

// A scan point takes the saliency of the nearest mesh vertex. A pick exists in the scan if some scan point
// has the picked vertex as its nearest; it is then the first such point, once per participant. Participants
// whose picks are all hidden stay, without picks. Saliency is empty if the mesh has none. Throws InputError
// if the ground truth does not fit the mesh. [tasse2016]
GroundTruth scan_ground_truth(const Scan& scan, const Mesh& mesh, const GroundTruth& mesh_truth);

}  // namespace salbench
