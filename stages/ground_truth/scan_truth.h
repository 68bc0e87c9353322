// SPDX-License-Identifier: GPL-3.0-or-later
// The ground truth of a mesh, transferred to one scan of it.
#pragma once

#include "stages/core/types.h"

namespace salbench {

// A scan point takes the saliency of the nearest mesh vertex. A pick exists in the scan if some scan point
// has the picked vertex as its nearest; it is then the first such point, once per participant. Participants
// whose picks are all hidden stay, without picks. Saliency is empty if the mesh has none. Throws InputError
// if the ground truth does not fit the mesh. [tasse2016]
GroundTruth scan_ground_truth(const Scan& scan, const Mesh& mesh, const GroundTruth& mesh_truth);

}  // namespace salbench
