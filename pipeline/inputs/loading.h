// SPDX-License-Identifier: GPL-3.0-or-later
// Functions of rows that read the shape of an item from its file, or take that of an import. They throw
// InputError, warn of what they leave out, and make a remark on polygons that were split, vertices that no
// face uses, and an odd scale.
#pragma once

#include <string>

#include "io/shapes/polygons.h"
#include "pipeline/engine/binding.h"
#include "stages/core/point_cloud.h"
#include "stages/core/types.h"

namespace salbench {

Mesh parsed_mesh(const Files& file, PolygonCounts* polygons);  // as the file has it, polygons split

Mesh load_mesh(const Files& file, const Remark& remark);
PointCloud load_cloud(const Files& file, const Remark& remark);

// What the two above make of what a file has.
Mesh usable_mesh(Mesh as_written, const PolygonCounts& polygons, const std::string& item,
                 const Remark& remark);
PointCloud usable_cloud(PointCloud as_written, const std::string& item, const Remark& remark);

Mesh mesh_of(const PointCloud& cloud, Surface surface);

}  // namespace salbench
