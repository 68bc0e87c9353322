// SPDX-License-Identifier: GPL-3.0-or-later
// Unit normals of meshes, scans and point clouds.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "stages/core/options.h"
#include "stages/core/types.h"
#include "stages/geometry/point_cloud.h"

namespace salbench {

inline constexpr std::int32_t kMaxNeighbours = 1000;  // beyond, a plane is no longer local

enum class MeshNormalsMethod { faces, pca };
template <>
struct EnumNames<MeshNormalsMethod> {
  static constexpr std::array<std::string_view, 2> names = {"faces", "pca"};
};

struct MeshNormalsOptions {
  MeshNormalsMethod method = MeshNormalsMethod::faces;
  std::int32_t neighbours = 0;              // pca: points in a plane fit, itself included; 0: see support
  double support = 0.01;                    // pca: radius in R, grown; gives the mean neighbour count to use
  std::int32_t most_neighbours = 30;        // pca: limit of that count
  std::int32_t orientation_neighbours = 6;  // pca: nearest others to which orientation propagates

  static MeshNormalsOptions text() { return {.method = MeshNormalsMethod::pca}; }  // as in the paper's text

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("method", self.method,
          {"faces: area-weighted face normals; pca: planes, oriented by Hoppe's tree"});
    visit("neighbours", self.neighbours,
          {"pca: nearest points of a plane, itself included, at least 3; 0: from the support", "points",
           between(0, kMaxNeighbours)});
    visit("support", self.support,
          {"pca: support radius, grown, that gives the number of neighbours", "R", above_and_up_to(0, 1)});
    visit("most_neighbours", self.most_neighbours,
          {"pca: limit of that number", "points", between(3, kMaxNeighbours)});
    visit("orientation_neighbours", self.orientation_neighbours,
          {"pca: nearest others in Hoppe's graph", "points", between(2, kMaxNeighbours)});
  }
};
void check(const MeshNormalsOptions& options);

// n x 3, outward as far as the method can determine.
//   faces: area-weighted sum of the face normals. A vertex whose faces have no area, or cancel, takes the
//          normal of the nearest vertex that has one. Throws InputError if no vertex has one.
//   pca:   takes the vertices as a point set: planes of the nearest points, oriented by Hoppe's tree. In each
//          component of the graph one outermost point is turned outwards, the one that faces its axis most.
//          If a neighbourhood spans no plane, the direction from the centroid decides. [hoppe1992]
// Throws InputError for vertices that are not finite.
Normals mesh_normals(const Mesh& mesh, const MeshNormalsOptions& options = {});

enum class ScanOrientation { camera, hoppe };
template <>
struct EnumNames<ScanOrientation> {
  static constexpr std::array<std::string_view, 2> names = {"camera", "hoppe"};
};

struct ScanNormalsOptions {
  std::int32_t neighbours = 18;  // nearest points in a plane fit, including the point itself
  ScanOrientation orientation = ScanOrientation::camera;
  std::int32_t orientation_neighbours = 6;  // hoppe: nearest others to which orientation propagates
  double gap = 3;                           // hoppe: limit of propagation, in median point spacings
  double max_normal_angle_degrees = 45;     // hoppe: limit between propagated normals, regardless of sign

  static ScanNormalsOptions text() {  // as in the paper's text, which gives no number of neighbours
    return {.neighbours = 9, .orientation = ScanOrientation::hoppe};
  }

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("neighbours", self.neighbours,
          {"nearest points of a plane, itself included", "points", between(3, kMaxNeighbours)});
    visit("orientation", self.orientation,
          {"each normal towards the camera by itself, or Hoppe's tree from the nearest point",
           {},
           {},
           "hoppe"});
    visit("orientation_neighbours", self.orientation_neighbours,
          {"hoppe: nearest others in the graph", "points", between(2, kMaxNeighbours)});
    visit(
        "gap", self.gap,
        {"hoppe: longest edge of the graph: beyond, depth jumps", "median point spacings", between(1, 1e6)});
    visit("steepest_degrees", self.max_normal_angle_degrees,
          {"hoppe: largest angle between normals across an edge", "degrees", between(1, 90)});
  }
};

// n x 3: planes of the nearest points. If a neighbourhood spans no plane, the direction to the camera
// decides.
//   camera: each normal is turned towards the camera, which sees its point.
//   hoppe:  by Hoppe's tree; in each component of the graph the point nearest to the camera is turned towards
//           it. The graph crosses neither depth jumps nor sharp folds, where a normal is no evidence for its
//           neighbours. [hoppe1992]
// The result is empty for an empty scan. Throws InputError for points that are not finite.
Normals scan_normals(const Scan& scan, const ScanNormalsOptions& options = {});

// n x 3: the cloud's own normals if it has them. Otherwise planes of the nearest points: with a viewpoint, as
// in scan_normals with the viewpoint as camera; without one, oriented by Hoppe's tree without the limits gap
// and max_normal_angle_degrees, and outwards at the outermost point of each component, as in mesh_normals.
// [hoppe1992]
Normals cloud_normals(const PointCloud& cloud, const ScanNormalsOptions& options = {});

}  // namespace salbench
