// SPDX-License-Identifier: GPL-3.0-or-later
// Rays against triangles or discs, for the stages that trace them. The .cpp alone knows the Embree library,
// and which of its versions 3 and 4 is installed.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "stages/core/types.h"

struct RTCSceneTy;

namespace salbench::embree {

struct Release {
  void operator()(RTCSceneTy* scene) const;
};
using Scene = std::unique_ptr<RTCSceneTy, Release>;  // ready for rays; read by several threads

// Both throw std::runtime_error if the library fails. Coordinates are rounded to float.
Scene scene_of_triangles(std::span<const Vec3> points, std::span<const Triangle> faces);
// Flat discs around the points, at right angles to the normals; radii as coordinates.
Scene scene_of_discs(std::span<const Vec3> points, std::span<const Vec3> normals,
                     std::span<const double> radii);

// True if the scene hits the ray between the two distances. Any hit is a hit, so neither the order in which
// Embree visits its tree nor the number of threads that built it changes the answer.
bool occluded(const Scene& scene, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float near,
              float far);

struct Hit {
  std::uint32_t face;
  float depth;  // along the direction, in its lengths
};

// Appends every face that the ray meets up to a limit, and returns that limit: `margin` behind the nearest
// face, infinity if there is none. Faces behind the limit may be among them, depending on the order in which
// Embree visits its tree.
float append_hits(const Scene& scene, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction,
                  float margin, std::vector<Hit>& hits);

// Calls `visit` for every triangle that may be within a radius of a place; what it returns is the radius from
// then on, if that is smaller.
void visit_near(const Scene& scene, const Eigen::Vector3f& place, float radius,
                const std::function<float(std::uint32_t face)>& visit);

const char* version();  // of its headers: the library says its own only once a device is started

}  // namespace salbench::embree
