// SPDX-License-Identifier: GPL-3.0-or-later
// What the readers owe to any bytes at all: they read them, or throw the one exception that they document.
// Each function throws std::logic_error, or lets another exception through, where that does not hold.
// libFuzzer calls them with ever new bytes (ctest --preset fuzz), a test with the corpora.
#pragma once

#include <string_view>

namespace salbench {

// A mesh has vertices for its faces, finite coordinates, comes back the same from the PLY file that it is
// written to, and is checked without dropping a face that is not counted.
void fuzz_off(std::string_view bytes);
void fuzz_obj(std::string_view bytes);
void fuzz_ply(std::string_view bytes);

// A point cloud has a normal for each point or none, and what is left of it when it is checked is finite,
// comes back the same when it is checked again, and has as many points as are not counted as dropped.
void fuzz_ply_cloud(std::string_view bytes);

void fuzz_val(std::string_view bytes);  // finite values, and for no more than one number of vertices
void fuzz_pid(std::string_view bytes);  // vertices of the mesh, and of no smaller one

// The head of an image, whose checksum holds: an array has as many values as its shape says.
void fuzz_head(std::string_view bytes);

void fuzz_config(std::string_view bytes);  // a configuration that is read back from its own text as the same
}  // namespace salbench
