// SPDX-License-Identifier: GPL-3.0-or-later
// Faces as elements that have values of their own, as points have them elsewhere.
#pragma once

#include <cstddef>
#include <vector>

#include "stages/core/types.h"
#include "stages/geometry/mesh_ops.h"

namespace salbench {

std::vector<Vec3> face_centroids(Points points, Surface faces);  // f x 3: means of the corners

ScalarField face_areas(Points points, Surface faces);  // f

// Faces that share an edge which no third face has: of edges where surfaces meet it is not known which faces
// go on into each other.
Adjacency face_adjacency(std::size_t n_points, Surface faces);

// The map by face: the mean of its corners, where NaN counts as 0; a map with a value per face as it is. A
// map with as many values as there are points is taken by point. Throws InputError for another number of
// values.
ScalarField values_by_face(FieldView map, std::size_t n_points, Surface faces);

}  // namespace salbench
