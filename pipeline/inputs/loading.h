// SPDX-License-Identifier: GPL-3.0-or-later
// The shape of an item, as its file has it, and as later rules read it: without what is left out, with a
// warning and a remark on polygons that were split, vertices that no face uses, and an odd scale. All throw
// InputError.
#pragma once

#include <span>
#include <string>

#include "io/hdf5/one_form.h"
#include "pipeline/engine/binding.h"
#include "stages/core/types.h"
#include "stages/geometry/point_cloud.h"

namespace salbench {

Mesh usable_mesh(Mesh as_written, const PolygonCounts& polygons, const std::string& item,
                 const Remark& remark);
PointCloud usable_cloud(PointCloud as_written, const std::string& item, const Remark& remark);

// Remark on coordinates that can be used, and hint at a wrong unit or at lost digits: one line; empty for
// what is usual. Nothing that is computed depends on the unit of length.
std::string odd_scale(std::span<const Vec3> points);

Mesh mesh_of(const PointCloud& cloud, Surface surface);

}  // namespace salbench
