// SPDX-License-Identifier: GPL-3.0-or-later
// Point clouds from PLY files without faces, with the normals and the viewpoint that the file has; colours
// and all else are skipped. Points keep the file's order. Coordinates may be NaN where nothing was seen:
// stages/geometry/point_cloud.h says what can be used. The front reads PCD and XYZ.
#pragma once

#include <filesystem>
#include <string_view>

#include "stages/geometry/point_cloud.h"

namespace salbench {

bool has_cloud_extension(const std::filesystem::path& path);  // .ply .pcd .xyz
bool has_shape_extension(const std::filesystem::path& path);  // of a mesh or of a point cloud

// True if the file holds points alone: .pcd and .xyz always do, .ply where its header announces no faces. A
// header that cannot be read announces some. `bytes` may be the beginning of the file's.
bool is_point_cloud(std::string_view bytes, const std::filesystem::path& path);

// The properties nx, ny and nz are normals; an element "camera" with view_px, view_py and view_pz is a
// viewpoint. Files name the origin where they know none: it counts for organised clouds only, which are what
// one camera saw (viewporty above 1). Throws InputError, one line that begins with `name` and, of text, the
// line; of bytes it has the number of the point.
PointCloud parse_ply_cloud(std::string_view bytes, std::string_view name);
bool ply_announces_faces(std::string_view bytes);

}  // namespace salbench
