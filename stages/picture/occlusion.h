// SPDX-License-Identifier: GPL-3.0-or-later
// Ambient occlusion: the part of the sky visible from a surface point past the shape itself.
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
  Vec3f normal = Vec3f::Zero();        // for shading, towards the camera
  Vec3f plane_normal = Vec3f::Zero();  // normal of the face, towards the camera
};

// [pixel]: 1 with a free view of the sky, 0 with none, weighted by the cosine to the normal. Directions are
// divided among 4 x 4 pixels and averaged over those on the same surface, which removes noise.
std::vector<float> openness(const embree::Scene& scene, const std::vector<Site>& sites,
                            const ImagePlane& plane, const PictureOptions& options, Rng rng);

}  // namespace salbench
