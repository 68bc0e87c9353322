// SPDX-License-Identifier: GPL-3.0-or-later
// Bounds the cost of models whose neighbourhoods grow with the shape: a fine surface is simplified, and its
// points receive interpolated values.
#pragma once

#include <cstddef>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

class CoarseSurface {
 public:
  // Keeps a surface of at most `most_faces` faces unchanged. Requires finite coordinates and valid faces.
  CoarseSurface(std::vector<Vec3> points, Surface surface, std::size_t most_faces);

  const Mesh& mesh() const { return is_coarse_ ? coarse_ : full_; }
  // Interpolates values at the mesh's vertices to the points of the shape.
  ScalarField on_all_points(ScalarField values) const;

 private:
  Mesh full_, coarse_;
  bool is_coarse_ = false;
};

}  // namespace salbench
