// SPDX-License-Identifier: GPL-3.0-or-later
// Point clouds from PLY files without faces, with normals and viewpoint if present; colours and other
// properties are skipped. Points keep the file's order. Coordinates may be NaN where nothing was measured:
// stages/geometry/point_cloud.h defines usable clouds. The front reads PCD and XYZ.
#pragma once

#include <filesystem>
#include <string_view>

#include "stages/geometry/point_cloud.h"

namespace salbench {

bool has_cloud_extension(const std::filesystem::path& path);  // .ply .pcd .xyz
bool has_shape_extension(const std::filesystem::path& path);  // mesh or point cloud

// True for a file with points only: .pcd and .xyz always, .ply if its header announces no faces. An
// unreadable header counts as one with faces. `bytes` may be the beginning of the file.
bool is_point_cloud(std::string_view bytes, const std::filesystem::path& path);

// Properties nx, ny and nz are normals; an element "camera" with view_px, view_py and view_pz is a viewpoint.
// Files contain the origin if they know none, so the origin counts only for organised clouds, which one
// camera measured (viewporty above 1). Throws InputError, one line that begins with `name` and names the line
// (text) or the number of the point (binary).
PointCloud parse_ply_cloud(std::string_view bytes, std::string_view name);
bool ply_announces_faces(std::string_view bytes);

}  // namespace salbench
