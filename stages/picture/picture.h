// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of shapes, without colours: visible surface and brightness per pixel, for a pinhole camera that
// looks at a mesh, a scan or a point cloud. Painting a saliency map is then a look-up.
//
// A picture is lit by one lamp that moves with the camera; the far side is dimmed but never black, and faces
// are two-sided. Creases and hollows are darkened by ambient occlusion.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "stages/core/options.h"
#include "stages/core/picture.h"
#include "stages/core/rng.h"
#include "stages/core/types.h"
#include "stages/geometry/point_cloud.h"

namespace salbench {

enum class PictureUp { automatic, y, z };
template <>
struct EnumNames<PictureUp> {
  static constexpr std::array<std::string_view, 3> names{"automatic", "y", "z"};
};

struct PictureOptions {
  std::int32_t size = 400;
  PictureUp up = PictureUp::automatic;
  double azimuth = 35;
  double elevation = 20;
  double scan_turn = 8;
  double field_of_view = 30;
  double margin = 0.04;
  double light_azimuth = -30;
  double light_elevation = 35;
  double ambient = 0.35;
  std::int32_t occlusion_samples = 4;
  double occlusion_reach = 0.5;
  double occlusion_strength = 0.75;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("size", self.size, {"width and height", "pixels", between(16, 2048)});
    visit("up", self.up,
          {"axis of the mesh that points up; automatic: y or z, on which it stands taller and shows more"});
    visit("azimuth", self.azimuth,
          {"of the camera of a mesh, around the upward axis; 0: in front of it", "degrees",
           between(-180, 180)});
    visit("elevation", self.elevation,
          {"of the camera of a mesh, above the horizon", "degrees", between(-89, 89)});
    visit("scan_turn", self.scan_turn,
          {"of the camera of a scan, around the upward axis, from where it was scanned", "degrees",
           between(-180, 180)});
    visit("field_of_view", self.field_of_view,
          {"between the edges of the picture; the distance follows from it", "degrees", between(1, 120)});
    visit("margin", self.margin, {"left empty along each edge", "width of the picture", between(0, 0.45)});
    visit("light_azimuth", self.light_azimuth,
          {"of the lamp, to the right of the camera", "degrees", between(-180, 180)});
    visit("light_elevation", self.light_elevation,
          {"of the lamp, above the camera", "degrees", between(-90, 90)});
    visit("ambient", self.ambient, {"brightness of what faces away from the lamp", {}, between(0, 1)});
    visit("occlusion_samples", self.occlusion_samples,
          {"rays per pixel for the ambient occlusion, shared by the 16 pixels around; 0: none",
           {},
           between(0, 1024)});
    visit("occlusion_reach", self.occlusion_reach,
          {"distance up to which surfaces darken each other", "radius of the shape", above(0)});
    visit("occlusion_strength", self.occlusion_strength,
          {"1: no light where nothing of the sky is seen; 0: no occlusion", {}, between(0, 1)});
  }
};

// Renders a mesh; `primitive` is a face index. All faces are drawn, and their orientation has no effect.
// Vertices without a face are ignored.
//
// All functions depend only on their arguments: they are thread-safe, and x86-64 machines agree. All throw
// InputError if a coordinate is not finite, or so large that its square overflows, if there is nothing to
// see, or all of it is in one place.
Picture picture_of_mesh(const Mesh& mesh, const PictureOptions& options, const RandomSource& random);

// Renders the partial mesh of a scan, and in its holes squares in the planes of the points; `primitive` is a
// point index, the nearest of the visible face's corners. The camera stands near the scan's own. The mesh
// from which `scan` was made determines the upward axis.
Picture picture_of_scan(const Scan& scan, const Normals& normals, Surface surface, const Mesh& mesh,
                        const PictureOptions& options, const RandomSource& random);

// Renders a point cloud in the same way. The camera stands near the viewpoint if there is one outside of the
// cloud, otherwise as for a mesh. The partial mesh, which may be empty, determines the upward axis.
Picture picture_of_cloud(const PointCloud& cloud, const Normals& normals, Surface surface,
                         const PictureOptions& options, const RandomSource& random);

}  // namespace salbench
