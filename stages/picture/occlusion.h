// SPDX-License-Identifier: GPL-3.0-or-later
// Ambient occlusion: the part of the sky that a place of the surface sees, with the shape in the way.
#pragma once

#include <vector>

#include "stages/core/rng.h"
#include "stages/geometry/embree.h"
#include "stages/picture/picture.h"
#include "stages/picture/raster.h"

namespace salbench {

// Surface point under a pixel, in eye space.
struct Site {
  bool seen = false;
  Vec3f position = Vec3f::Zero();
  Vec3f normal = Vec3f::Zero();        // as it is shaded, towards the camera
  Vec3f plane_normal = Vec3f::Zero();  // of the face, towards the camera
};

// [pixel]: 1 with a free view of the sky, 0 with none, weighted by the cosine to the normal. The directions
// are shared among 4 x 4 pixels and averaged over those on the same surface, so that no noise is left.
std::vector<float> openness(const embree::Scene& scene, const std::vector<Site>& sites,
                            const ImagePlane& plane, const PictureOptions& options, Rng rng);

}  // namespace salbench
