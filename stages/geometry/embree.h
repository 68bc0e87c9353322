// SPDX-License-Identifier: GPL-3.0-or-later
// Intersection of rays with triangles or discs. Only the .cpp uses the Embree library, version 3 or 4,
// whichever is installed.
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
using Scene = std::unique_ptr<RTCSceneTy, Release>;  // ready for rays; shared by threads

// Both throw std::runtime_error if the library fails, and round coordinates to float.
Scene scene_of_triangles(std::span<const Vec3> points, std::span<const Triangle> faces);
// Flat discs around the points, perpendicular to the normals; radii in the unit of the coordinates.
Scene scene_of_discs(std::span<const Vec3> points, std::span<const Vec3> normals,
                     std::span<const double> radii);

// True if anything in the scene meets the ray between the two distances. Independent of the order in which
// Embree visits its tree, and of the number of threads that built it.
bool occluded(const Scene& scene, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float near,
              float far);

struct Hit {
  std::uint32_t face;
  float depth;  // in multiples of the direction's length
};

// Appends every face that the ray meets up to a limit, and returns the limit: `margin` behind the nearest
// face, or infinity if there is none. Faces behind the limit may be included, depending on the order in which
// Embree visits its tree.
float append_hits(const Scene& scene, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction,
                  float margin, std::vector<Hit>& hits);

// Calls `visit` for every triangle that may be within a radius of a position; the returned value replaces the
// radius if it is smaller.
void visit_near(const Scene& scene, const Eigen::Vector3f& place, float radius,
                const std::function<float(std::uint32_t face)>& visit);

const char* version();  // header version: the library reports its own only after creating a device

}  // namespace salbench::embree
