// SPDX-License-Identifier: GPL-3.0-or-later
// Functions of rows that read the shape of an item from its file. They throw InputError, warn of what they
// leave out, and make a remark on polygons that were split and on an odd scale.
#pragma once

#include "io/polygons.h"
#include "pipeline/engine/binding.h"
#include "stages/core/point_cloud.h"
#include "stages/core/types.h"

namespace salbench {

Mesh parsed_mesh(const Files& file, PolygonCounts* polygons);  // as the file has it, polygons split

Mesh load_mesh(const Files& file, const Remark& remark);
PointCloud load_cloud(const Files& file, const Remark& remark);

Mesh mesh_of(const PointCloud& cloud, Surface surface);

}  // namespace salbench
