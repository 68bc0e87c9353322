// SPDX-License-Identifier: GPL-3.0-or-later
// Ambient occlusion: the part of the sky that a place of the surface sees, with the shape in the way.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "stages/core/rng.h"
#include "stages/core/types.h"
#include "stages/picture/picture.h"
#include "stages/picture/raster.h"

namespace salbench {

// A shape in eye space that rays are sent against.
class Occluders {
 public:
  Occluders(std::span<const Vec3> points, std::span<const Triangle> faces);
  explicit Occluders(std::span<const Disc> discs);  // round ones
  ~Occluders();

  bool between(const Vec3f& origin, const Vec3f& direction, float reach) const;

 private:
  struct Scene;
  std::unique_ptr<Scene> scene_;
};

// Surface point under a pixel, in eye space.
struct Site {
  bool seen = false;
  Vec3f position = Vec3f::Zero();
  Vec3f normal = Vec3f::Zero();        // as it is shaded, towards the camera
  Vec3f plane_normal = Vec3f::Zero();  // of the face or disc, towards the camera
  float lift = 0;                      // height above the surface at which rays begin
};

// [pixel]: 1 with a free view of the sky, 0 with none, weighted by the cosine to the normal. The directions
// are shared among 4 x 4 pixels and averaged over those on the same surface, so that no noise is left.
std::vector<float> openness(const Occluders& occluders, const std::vector<Site>& sites,
                            const ImagePlane& plane, const PictureOptions& options, Rng rng);

}  // namespace salbench
