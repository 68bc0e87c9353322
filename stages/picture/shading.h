// SPDX-License-Identifier: GPL-3.0-or-later
// How bright a white surface is under the picture's lamp.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "stages/core/types.h"
#include "stages/picture/picture.h"
#include "stages/picture/raster.h"

namespace salbench {

// Normals in the corners of faces, each a mean over the faces around the corner that meet its own face at
// less than kCreaseDegrees, so that round shapes look round and edges stay edges. Whichever way the faces are
// turned, those of one face point to the same side of it: the side of its own corners' order.
class CornerNormals {
 public:
  static constexpr double kCreaseDegrees = 50;

  // Of the faces that are wanted: [face].
  CornerNormals(std::span<const Vec3> points, std::span<const Triangle> faces,
                const std::vector<bool>& wanted);

  const Vec3f& of_face(std::int32_t face) const { return planes_[static_cast<std::size_t>(face)]; }
  Vec3f at(std::int32_t face, const Vec3& weights) const;  // unit length; weights of the corners

 private:
  std::vector<Vec3f> planes_;                  // face: unit normal; 0 of a face without area
  std::vector<std::array<Vec3f, 3>> corners_;  // face
};

// The lamp stands still against the camera.
class Lamp {
 public:
  explicit Lamp(const PictureOptions& options);
  // In [ambient, 1], for a normal in eye space that points towards the camera.
  float brightness(const Vec3f& normal) const;

 private:
  Vec3f towards_;
  float ambient_;
};

}  // namespace salbench
