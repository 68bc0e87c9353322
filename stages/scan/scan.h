// SPDX-License-Identifier: GPL-3.0-or-later
// Simulated range images: points of a mesh seen by a depth camera from the corners of an icosahedron.
// [tasse2016]
//
// The camera looks at the area-weighted centroid of the mesh. Its rays form a square grid in the image plane
// with one ray through the centroid, wide enough for the sphere around the centroid that contains the mesh,
// up to kMaxHalfField. A point of the scan is the nearest hit of one ray.
#pragma once

#include <array>
#include <memory>
#include <numbers>
#include <string_view>

#include "stages/core/options.h"
#include "stages/core/types.h"

namespace salbench {

inline constexpr int kViews = 12;

// Largest angle between a ray and the central one. A slender shape that extends past the camera would need
// rays in all directions.
inline constexpr double kMaxHalfField = std::numbers::pi / 3;

enum class UpAxis { y, z };
template <>
struct EnumNames<UpAxis> {
  static constexpr std::array<std::string_view, 2> names{"y", "z"};
};

struct ScanOptions {
  double distance = 3;          // camera to area centroid, in sqrt(surface area)
  double step_degrees = 0.125;  // the image plane's step is the tangent of this angle
  UpAxis up = UpAxis::z;
  double phase = 0;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("distance", self.distance,
          {"from the camera to the area-weighted centroid", "sqrt(surface area)", above_and_up_to(0, 1e4)});
    visit("step_degrees", self.step_degrees,
          {"angle between neighbouring rays at the image centre", "degrees", between(0.01, 10)});
    visit("up", self.up, {"axis of the mesh that points up in the image: it orders the points", {}, {}, "y"});
    visit("phase", self.phase,
          {"shift of the grid to the right and up; 0: one ray through the centroid", "steps",
           between(-0.5, 0.5), "0"});
  }
};

// A mesh prepared for scanning, shared by its views: preparation takes a large part of one scan's time.
class ScanScene {
 public:
  // The mesh must outlive the scene. Throws InputError if the surface area is 0 or not finite.
  explicit ScanScene(const Mesh& mesh);
  explicit ScanScene(Mesh&&) = delete;
  ScanScene(ScanScene&&) noexcept;
  ScanScene& operator=(ScanScene&&) noexcept;
  ~ScanScene();

  // Scan of view 0..kViews-1 in the mesh's own coordinates, row by row: rows from top to bottom, each from
  // left to right, as the camera sees them. Every point lies on a face, to double precision. Faces are
  // two-sided; vertices without a face are ignored.
  //
  // Depends only on the mesh and the arguments: thread-safe, and x86-64 machines agree. Throws InputError if
  // no ray meets the mesh.
  Scan scan(int view, const ScanOptions& options = {}) const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

// A single view.
Scan simulate_scan(const Mesh& mesh, int view, const ScanOptions& options = {});

}  // namespace salbench
