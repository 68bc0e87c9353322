// SPDX-License-Identifier: GPL-3.0-or-later
// Faces as elements with values, like points elsewhere.
#pragma once

#include <cstddef>
#include <vector>

#include "stages/core/types.h"
#include "stages/geometry/mesh_ops.h"

namespace salbench {

std::vector<Vec3> face_centroids(Points points, Surface faces);  // f x 3: means of the corners

ScalarField face_areas(Points points, Surface faces);  // f

// Faces that share an edge belonging to exactly two faces: at an edge with more faces, it is unknown which of
// them continue each other.
Adjacency face_adjacency(std::size_t n_points, Surface faces);

// The map per face: the mean over its corners with NaN as 0; a map that already has one value per face is
// returned as is. If points and faces are equal in number, the map is per point. Throws InputError for any
// other number of values.
ScalarField values_by_face(FieldView map, std::size_t n_points, Surface faces);

}  // namespace salbench
