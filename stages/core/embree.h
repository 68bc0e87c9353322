// SPDX-License-Identifier: GPL-3.0-or-later
// Shared by the stages that trace rays: the only files of the program that know the Embree library.
#pragma once

#include <memory>
#include <span>
#include <type_traits>

#include <embree3/rtcore.h>

#include "stages/core/types.h"

namespace salbench::embree {

template <auto release>
struct Release {
  template <class Handle>
  void operator()(Handle* handle) const {
    release(handle);
  }
};
using Scene = std::unique_ptr<std::remove_pointer_t<RTCScene>, Release<rtcReleaseScene>>;
using Geometry = std::unique_ptr<std::remove_pointer_t<RTCGeometry>, Release<rtcReleaseGeometry>>;

// All throw std::runtime_error if the library fails. Coordinates are rounded to float.
Geometry triangles(std::span<const Vec3> points, std::span<const Triangle> faces);
// Flat discs around the points, at right angles to the normals; radii as coordinates.
Geometry discs(std::span<const Vec3> points, std::span<const Vec3> normals, std::span<const double> radii);

// Whether the scene hits the ray between the two distances. Any hit is a hit, so neither the order in which
// Embree visits its tree nor the number of threads that built it changes the answer.
bool occluded(const Scene& scene, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float near,
              float far);

// The geometry as a scene of its own, ready for rays; `further` flags beside ROBUST.
Scene scene_of(const Geometry& geometry, RTCSceneFlags further = RTC_SCENE_FLAG_NONE);

}  // namespace salbench::embree
