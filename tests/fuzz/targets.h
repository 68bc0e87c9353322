// SPDX-License-Identifier: GPL-3.0-or-later
// Requirements on the readers for arbitrary bytes: they succeed, or throw the one documented exception. Each
// function throws std::logic_error, or passes on another exception, if that is violated. libFuzzer calls them
// with ever new bytes (ctest --preset fuzz), a test with the corpora.
#pragma once

#include <string_view>

namespace salbench {

// A mesh has all vertices of its faces and finite coordinates, survives a round trip through a PLY file, and
// is checked without dropping an uncounted face.
void fuzz_off(std::string_view bytes);
void fuzz_obj(std::string_view bytes);
void fuzz_ply(std::string_view bytes);

// A point cloud has a normal for each point or none. After the check, its points are finite, another check
// changes nothing, and the dropped points are counted.
void fuzz_ply_cloud(std::string_view bytes);

void fuzz_val(std::string_view bytes);  // finite values, accepted for only one number of vertices
void fuzz_pid(std::string_view bytes);  // vertices of the mesh, rejected for a smaller one

// The head of an image with a valid checksum: arrays have as many values as their shape.
void fuzz_head(std::string_view bytes);

void fuzz_config(std::string_view bytes);  // a configuration equals the one read back from its text
}  // namespace salbench
