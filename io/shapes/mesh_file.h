// SPDX-License-Identifier: GPL-3.0-or-later
// Triangle meshes from files as found in practice.
//
// Polygons are split into triangles (io/shapes/polygons.h); vertices keep the file's numbering, used by a
// face or not; colours, normals and texture coordinates are skipped. The result may have no faces:
// stages/geometry/mesh_check.h defines usable meshes.
#pragma once

#include <filesystem>
#include <string_view>

#include "io/shapes/polygons.h"
#include "stages/core/types.h"

namespace salbench {

// Selects the format by extension, in either case. Throws InputError, one line "PATH:LINE: problem", for
// files that are unreadable, truncated or not a mesh, and for self-intersecting polygons: every count, index
// and coordinate is checked. Binary formats name the element and the byte instead of the line. `counts`, if
// given, receives the split polygons.
Mesh read_mesh(const std::filesystem::path& path);
Mesh parse_mesh(std::string_view bytes, const std::filesystem::path& path,  // from the file's bytes
                PolygonCounts* counts = nullptr);

bool has_mesh_extension(const std::filesystem::path& path);  // .off .obj .ply

// The same from memory; messages use `name` as the path.
//   OFF: [C][N][ST]OFF, also without a header word.
//   OBJ: v and f records; others are skipped.
//   PLY: ascii, binary little and big endian.
Mesh parse_off(std::string_view text, std::string_view name, PolygonCounts* counts = nullptr);
Mesh parse_obj(std::string_view text, std::string_view name, PolygonCounts* counts = nullptr);
Mesh parse_ply(std::string_view bytes, std::string_view name, PolygonCounts* counts = nullptr);

}  // namespace salbench
