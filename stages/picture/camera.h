// SPDX-License-Identifier: GPL-3.0-or-later
// Pinhole camera of a picture, placed so that the shape fills it.
//
// Eye space: x to the right, y up, z away from the camera at the origin; the unit is the shape's radius. It
// is left-handed, which has no effect: faces have two sides.
#pragma once

#include <array>
#include <span>

#include "stages/core/types.h"
#include "stages/picture/picture.h"

namespace salbench {

// Orthonormal axes of the camera in the world; `back` points from the shape to the camera.
struct CameraAxes {
  Vec3 right, up, back;
};

// Upward axis of a mesh under these options; y if it has no faces.
Vec3 upward(const Mesh& mesh, const PictureOptions& options);

CameraAxes axes_for_mesh(const Vec3& up, const PictureOptions& options);
CameraAxes axes_for_scan(const Vec3& up, const Vec3& towards_scanner, const PictureOptions& options);

class Camera {
 public:
  // Looks at the points. Throws InputError: no points, not finite, too large, or all in one place. `shape` is
  // the shape's name in the message.
  Camera(std::span<const Vec3> points, const CameraAxes& axes, const PictureOptions& options,
         const char* shape);

  double unit() const { return unit_; }  // radius of the shape, mesh unit
  double tan_half_field() const { return tan_half_; }
  Vec3 eye_from_world(const Vec3& point) const;
  Vec3 eye_from_world_direction(const Vec3& direction) const;  // not scaled
  std::array<double, 16> view_projection() const;              // see Picture

 private:
  CameraAxes axes_;
  Vec3 centre_;  // centre of the shape, world
  double unit_ = 1;
  Vec3 position_;  // right, up and back from the centre, in units
  double tan_half_ = 1;
};

}  // namespace salbench
