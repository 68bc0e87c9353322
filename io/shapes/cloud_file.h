// SPDX-License-Identifier: GPL-3.0-or-later
// Point clouds from files: PLY without faces, PCD and XYZ, with the normals and the viewpoint that the file
// has; colours and all else are skipped. Points keep the file's order. Coordinates may be NaN where nothing
// was seen: stages/geometry/point_cloud.h says what can be used.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

#include "stages/geometry/point_cloud.h"

namespace salbench {

bool has_cloud_extension(const std::filesystem::path& path);  // .ply .pcd .xyz
bool has_shape_extension(const std::filesystem::path& path);  // of a mesh or of a point cloud

// True if the file holds points alone: .pcd and .xyz always do, .ply where its header announces no faces. A
// header that cannot be read announces some. `bytes` may be the beginning of the file's.
bool is_point_cloud(std::string_view bytes, const std::filesystem::path& path);

// By extension. Throws InputError, one line "PATH:LINE: what is wrong", for what is unreadable, cut short, or
// no point cloud. Binary formats name the point and the byte instead of the line.
PointCloud parse_cloud(std::string_view bytes, const std::filesystem::path& path);  // the bytes of that file

// The same from memory; messages say `name` for the path.
//   PLY: nx, ny and nz are normals; an element "camera" with view_px, view_py and view_pz is a viewpoint.
//   PCD: ascii, binary and binary_compressed; normal_x, normal_y and normal_z are normals.
//   XYZ: a point per line, x y z or x y z nx ny nz; # begins a comment; the first line may hold their number.
// PCD and PLY files name the origin where they know no viewpoint. It counts for organised clouds only, which
// are what one camera saw (PCD: HEIGHT above 1; PLY: viewporty above 1).
PointCloud parse_ply_cloud(std::string_view bytes, std::string_view name);
bool ply_announces_faces(std::string_view bytes);
PointCloud parse_pcd(std::string_view bytes, std::string_view name);
PointCloud parse_xyz(std::string_view text, std::string_view name);

}  // namespace salbench
