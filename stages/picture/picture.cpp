// SPDX-License-Identifier: GPL-3.0-or-later
// Each pixel is cut into 3 x 3 cells, so that one of them has its centre; edges are smoothed by all nine.
// A pixel shows what its centre shows, or else the nearest cell that shows something.
#include "stages/picture/picture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "stages/core/check.h"
#include "stages/core/errors.h"
#include "stages/picture/camera.h"
#include "stages/picture/discs.h"
#include "stages/picture/occlusion.h"
#include "stages/picture/raster.h"
#include "stages/picture/shading.h"

namespace salbench {
namespace {

constexpr int kCells = 3;  // along each side of a pixel
constexpr int kCellsPerPixel = kCells * kCells;

// The image planes of a picture: its pixels, and their cells.
struct Planes {
  ImagePlane pixels, cells;

  Planes(const Camera& camera, const PictureOptions& options)
      : pixels{options.size, camera.tan_half_field()},
        cells{options.size * kCells, camera.tan_half_field()} {}

  // The cells of a pixel from its centre outwards.
  std::array<int, kCellsPerPixel> cells_of(int pixel) const {
    static constexpr std::array<std::array<int, 2>, kCellsPerPixel> kOutwards = {
        {{1, 1}, {0, 1}, {1, 0}, {1, 2}, {2, 1}, {0, 0}, {0, 2}, {2, 0}, {2, 2}}};
    const int row = pixel / pixels.side * kCells, column = pixel % pixels.side * kCells;
    std::array<int, kCellsPerPixel> cells_in{};
    for (std::size_t k = 0; k < cells_in.size(); ++k)
      cells_in[k] = (row + kOutwards[k][0]) * cells.side + column + kOutwards[k][1];
    return cells_in;
  }

  // The cell that stands for a pixel; -1: nothing is seen.
  int shown(int pixel, const Seen& seen) const {
    for (const int cell : cells_of(pixel))
      if (seen.primitive[static_cast<std::size_t>(cell)] >= 0) return cell;
    return -1;
  }
};

// Queries that faces and discs answer alike, once they are seen.
struct Surfaces {
  virtual ~Surfaces() = default;
  virtual Vec3 weights(std::int32_t primitive, const Vec3& ray) const = 0;
  virtual Vec3f plane_normal(std::int32_t primitive, const Vec3& ray) const = 0;  // towards the viewer
  virtual float lift(std::int32_t primitive) const = 0;
};

Site site_of(int cell, const Seen& seen, const ImagePlane& cells, const Surfaces& surfaces) {
  const auto at = static_cast<std::size_t>(cell);
  const Vec3 ray = cells.ray_of_cell(cell);
  const std::int32_t primitive = seen.primitive[at];
  return {true, (static_cast<double>(seen.depth[at]) * ray).cast<float>(), seen.normal[at],
          surfaces.plane_normal(primitive, ray), surfaces.lift(primitive)};
}

std::uint8_t byte_of(float part) {
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(part, 0.0F, 1.0F)));
}

// Values that compress well and lose nothing that a picture shows: steps of a power of two, whose lower bits
// are all zero.
constexpr double kWeightSteps = 65536;
double depth_step(double unit) { return std::exp2(std::floor(std::log2(unit)) - 15); }

Vec3f rounded_weights(const Vec3& weights) {
  Vec3 steps = (weights * kWeightSteps).array().round();
  Eigen::Index largest = 0;
  weights.maxCoeff(&largest);
  steps[largest] += kWeightSteps - steps.sum();
  return (steps / kWeightSteps).cast<float>();
}

struct Developer {
  const Camera& camera;
  const PictureOptions& options;
  const Planes planes;
  const Seen& seen;
  const Surfaces& surfaces;

  Picture develop(const Occluders& occluders, const Rng& rng) const {
    Picture picture = blank();
    std::vector<Site> sites(picture.pixels());
    for (int pixel = 0; pixel < static_cast<int>(picture.pixels()); ++pixel)
      if (const int cell = planes.shown(pixel, seen); cell >= 0) {
        show(cell, static_cast<std::size_t>(pixel), picture);
        sites[static_cast<std::size_t>(pixel)] = site_of(cell, seen, planes.cells, surfaces);
      }
    shade(openness(occluders, sites, planes.pixels, options, rng), picture);
    return picture;
  }

 private:
  Picture blank() const {
    Picture picture;
    picture.size = options.size;
    picture.view_projection = camera.view_projection();
    picture.primitive.assign(picture.pixels(), -1);
    picture.weights.assign(3 * picture.pixels(), 0);
    picture.depth.assign(picture.pixels(), std::numeric_limits<float>::infinity());
    picture.shade.assign(picture.pixels(), 255);
    picture.coverage.assign(picture.pixels(), 0);
    return picture;
  }

  void show(int cell, std::size_t pixel, Picture& picture) const {
    const auto at = static_cast<std::size_t>(cell);
    const double step = depth_step(camera.unit());
    picture.primitive[pixel] = seen.primitive[at];
    picture.depth[pixel] =
        static_cast<float>(std::round(static_cast<double>(seen.depth[at]) * camera.unit() / step) * step);
    const Vec3f weights =
        rounded_weights(surfaces.weights(seen.primitive[at], planes.cells.ray_of_cell(cell)));
    std::copy(weights.begin(), weights.end(), &picture.weights[3 * pixel]);
  }

  void shade(const std::vector<float>& open, Picture& picture) const {
    const Lamp lamp(options);
    for (std::size_t pixel = 0; pixel < picture.pixels(); ++pixel) {
      if (picture.primitive[pixel] < 0) continue;
      float sum = 0;
      int count = 0;
      for (const int cell : planes.cells_of(static_cast<int>(pixel))) {
        if (seen.primitive[static_cast<std::size_t>(cell)] < 0) continue;
        sum += lamp.brightness(seen.normal[static_cast<std::size_t>(cell)]);
        ++count;
      }
      const float light = 1 - static_cast<float>(options.occlusion_strength) * (1 - open[pixel]);
      picture.shade[pixel] = byte_of(light * sum / static_cast<float>(count));
      picture.coverage[pixel] = byte_of(static_cast<float>(count) / kCellsPerPixel);
    }
  }
};

void require_something_seen(const Seen& seen, const char* shape) {
  if (std::all_of(seen.primitive.begin(), seen.primitive.end(), [](std::int32_t p) { return p < 0; }))
    throw ShapeError(std::string("no pixel shows the ") + shape +
                     ": its surface has no area, or is seen edge-on");
}

// --- meshes -----------------------------------------------------------------------------------------------

struct FaceSurfaces final : Surfaces {
  const std::vector<Vec3>& points;  // eye space
  const std::vector<Triangle>& faces;
  const CornerNormals& normals;

  FaceSurfaces(const std::vector<Vec3>& the_points, const std::vector<Triangle>& the_faces,
               const CornerNormals& the_normals)
      : points(the_points), faces(the_faces), normals(the_normals) {}
  Vec3 weights(std::int32_t face, const Vec3& ray) const override {
    return weights_at(points, faces[static_cast<std::size_t>(face)], ray);
  }
  Vec3f plane_normal(std::int32_t face, const Vec3& ray) const override {
    const Vec3f& normal = normals.of_face(face);
    return normal.dot(ray.cast<float>()) > 0 ? Vec3f(-normal) : normal;
  }
  float lift(std::int32_t) const override { return 1e-3F; }
};

std::vector<Vec3> corners_of(const Mesh& mesh) {
  std::vector<bool> used(mesh.vertices.size(), false);
  for (const Triangle& face : mesh.faces)
    for (const std::int32_t v : face) used[static_cast<std::size_t>(v)] = true;
  std::vector<Vec3> corners;
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i]) corners.push_back(mesh.vertices[i]);
  return corners;
}

// The side that is seen of a face decides, not the smooth normal, which may lean away along an outline.
void add_normals(const FaceSurfaces& surfaces, const ImagePlane& cells, Seen& seen) {
  for (std::size_t cell = 0; cell < seen.primitive.size(); ++cell) {
    const std::int32_t face = seen.primitive[cell];
    if (face < 0) continue;
    const Vec3 ray = cells.ray_of_cell(static_cast<int>(cell));
    const Vec3f normal = surfaces.normals.at(face, surfaces.weights(face, ray));
    seen.normal[cell] = surfaces.normals.of_face(face).dot(ray.cast<float>()) > 0 ? Vec3f(-normal) : normal;
  }
}

// --- points -----------------------------------------------------------------------------------------------

struct DiscSurfaces final : Surfaces {
  const std::vector<Disc>& discs;

  explicit DiscSurfaces(const std::vector<Disc>& the_discs) : discs(the_discs) {}
  Vec3 weights(std::int32_t, const Vec3&) const override { return Vec3::UnitX(); }
  Vec3f plane_normal(std::int32_t point, const Vec3&) const override {
    return discs[static_cast<std::size_t>(point)].normal.cast<float>();
  }
  float lift(std::int32_t point) const override {
    return static_cast<float>(discs[static_cast<std::size_t>(point)].radius);
  }
};

}  // namespace

Picture picture_of_mesh(const Mesh& mesh, const PictureOptions& options, const RandomSource& random) {
  const Camera camera(corners_of(mesh), axes_for_mesh(upward(mesh, options), options), options, "mesh");
  const Planes planes(camera, options);
  std::vector<Vec3> points;
  for (const Vec3& p : mesh.vertices) points.push_back(camera.eye_from_world(p));
  Seen seen = see_faces(points, mesh.faces, planes.cells);
  require_something_seen(seen, "mesh");

  std::vector<bool> visible(mesh.faces.size(), false);
  for (const std::int32_t face : seen.primitive)
    if (face >= 0) visible[static_cast<std::size_t>(face)] = true;
  const CornerNormals normals(points, mesh.faces, visible);
  const FaceSurfaces surfaces(points, mesh.faces, normals);
  add_normals(surfaces, planes.cells, seen);
  return Developer{camera, options, planes, seen, surfaces}.develop(Occluders(points, mesh.faces),
                                                                    random.rng("picture"));
}

Picture picture_of_scan(const Scan& scan, const Normals& normals, const Mesh& mesh,
                        const PictureOptions& options, const RandomSource& random) {
  CHECK_EQ(scan.points.size(), normals.size());
  Vec3 centre = Vec3::Zero();
  for (const Vec3& p : scan.points) centre += p / static_cast<double>(scan.points.size());
  const Camera camera(scan.points, axes_for_scan(upward(mesh, options), scan.camera - centre, options),
                      options, "scan");
  const Planes planes(camera, options);
  const std::vector<Disc> discs = discs_of(scan, normals, camera);
  const Seen seen = see_discs(discs, planes.cells);
  require_something_seen(seen, "scan");
  return Developer{camera, options, planes, seen, DiscSurfaces(discs)}.develop(Occluders(discs),
                                                                               random.rng("picture"));
}

Picture picture_of_cloud(const PointCloud& cloud, const Normals& normals, Surface surface,
                         const PictureOptions& options, const RandomSource& random) {
  CHECK_EQ(cloud.points.size(), normals.size());
  Eigen::AlignedBox3d box;
  for (const Vec3& p : cloud.points) box.extend(p);
  const Vec3 up = upward(Mesh{cloud.points, {surface.begin(), surface.end()}}, options);
  const bool from_outside = cloud.viewpoint && !box.contains(*cloud.viewpoint);
  const CameraAxes axes =
      from_outside ? axes_for_scan(up, *cloud.viewpoint - box.center(), options) : axes_for_mesh(up, options);
  const Camera camera(cloud.points, axes, options, "point cloud");
  const Planes planes(camera, options);
  const std::vector<Disc> discs = discs_of(Points(cloud.points), normals, camera);
  const Seen seen = see_discs(discs, planes.cells);
  require_something_seen(seen, "point cloud");
  return Developer{camera, options, planes, seen, DiscSurfaces(discs)}.develop(Occluders(discs),
                                                                               random.rng("picture"));
}

}  // namespace salbench
