// SPDX-License-Identifier: GPL-3.0-or-later
// VD, vertex degree: the floor that knows the meshing alone, and nothing of the shape. What it scores is what
// a learnt model may pick up from where its authors, or the program that made a mesh, put the edges.
#pragma once

#include "stages/core/options.h"
#include "stages/core/types.h"

namespace salbench {

using VdOptions = NoOptions;

// Number of edges at a point; 0 where no face is. Of points without a mesh, those of their partial mesh. It
// depends on no coordinate. O(n). Throws InputError for a face whose point does not exist.
ScalarField vd_saliency(Points points, Surface surface, const VdOptions& options);

}  // namespace salbench
