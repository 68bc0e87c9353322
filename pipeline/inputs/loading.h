// SPDX-License-Identifier: GPL-3.0-or-later
// Shape of an item as in its file, and as later rules read it: cleaned, with a warning and a remark on split
// polygons, vertices that no face uses, and an unusual scale. All throw InputError.
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

// One-line remark on usable coordinates that suggest a wrong unit or lost digits; empty if they are usual. No
// result depends on the unit of length.
std::string odd_scale(std::span<const Vec3> points);

Mesh mesh_of(const PointCloud& cloud, Surface surface);

}  // namespace salbench
