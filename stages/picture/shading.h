// SPDX-License-Identifier: GPL-3.0-or-later
// Brightness of a white surface under the picture's lamp.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "stages/core/types.h"
#include "stages/picture/picture.h"
#include "stages/picture/raster.h"

namespace salbench {

// Normals at the corners of faces, each a mean over the faces around the corner that meet its own face at
// less than kCreaseDegrees, so that round shapes look round and edges sharp. Whatever the orientation of the
// faces, normals of a face point to the side given by its own corners' order.
class CornerNormals {
 public:
  static constexpr double kCreaseDegrees = 50;

  // Computed for the `wanted` faces: [face].
  CornerNormals(std::span<const Vec3> points, std::span<const Triangle> faces,
                const std::vector<bool>& wanted);

  const Vec3f& of_face(std::int32_t face) const { return planes_[static_cast<std::size_t>(face)]; }
  Vec3f at(std::int32_t face, const Vec3& weights) const;  // unit length; weights of the corners

 private:
  std::vector<Vec3f> planes_;                  // face: unit normal; 0 without area
  std::vector<std::array<Vec3f, 3>> corners_;  // face
};

// The lamp is fixed relative to the camera.
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
