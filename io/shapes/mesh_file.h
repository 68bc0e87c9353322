// SPDX-License-Identifier: GPL-3.0-or-later
// Triangle meshes from files as they are found in the wild.
//
// Polygons are split into triangles (io/shapes/polygons.h); vertices keep the file's numbering, whether a
// face uses them or not; colours, normals and texture coordinates are skipped. A mesh may come out without
// faces: stages/geometry/mesh_check.h says what can be used.
#pragma once

#include <filesystem>
#include <string_view>

#include "io/shapes/polygons.h"
#include "stages/core/types.h"

namespace salbench {

// By extension, in upper or lower case. Throws InputError, one line "PATH:LINE: what is wrong", for what is
// unreadable, cut short, or no mesh, and for a polygon that crosses itself: every count, index and coordinate
// is checked. Binary formats name the element and the byte instead of the line. `counts`, where it is given,
// takes what was split.
Mesh read_mesh(const std::filesystem::path& path);
Mesh parse_mesh(std::string_view bytes, const std::filesystem::path& path,  // the bytes of that file
                PolygonCounts* counts = nullptr);

bool has_mesh_extension(const std::filesystem::path& path);  // .off .obj .ply

// The same from memory; messages say `name` for the path.
//   OFF: [C][N][ST]OFF, also without a header word.
//   OBJ: v and f records; all others are skipped.
//   PLY: ascii, binary little and big endian.
Mesh parse_off(std::string_view text, std::string_view name, PolygonCounts* counts = nullptr);
Mesh parse_obj(std::string_view text, std::string_view name, PolygonCounts* counts = nullptr);
Mesh parse_ply(std::string_view bytes, std::string_view name, PolygonCounts* counts = nullptr);

}  // namespace salbench
