// SPDX-License-Identifier: GPL-3.0-or-later
// Each pixel is divided into 3 x 3 cells, one of them at its centre; all nine smooth the edges. A pixel shows
// the surface at its centre, or else in the nearest cell that has one.
#include "stages/picture/picture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "stages/core/check.h"
#include "stages/core/errors.h"
#include "stages/core/field.h"
#include "stages/geometry/embree.h"
#include "stages/geometry/mesh_ops.h"
#include "stages/geometry/neighbours.h"
#include "stages/picture/camera.h"
#include "stages/picture/occlusion.h"
#include "stages/picture/raster.h"
#include "stages/picture/shading.h"

namespace salbench {
namespace {

constexpr int kCells = 3;  // per side of a pixel
constexpr int kCellsPerPixel = kCells * kCells;

// Cells of a pixel from its centre outwards.
std::array<std::size_t, kCellsPerPixel> cells_of(int pixel, int side) {
  static constexpr std::array<std::array<int, 2>, kCellsPerPixel> kOutwards = {
      {{1, 1}, {0, 1}, {1, 0}, {1, 2}, {2, 1}, {0, 0}, {0, 2}, {2, 0}, {2, 2}}};
  const int row = pixel / side * kCells, column = pixel % side * kCells;
  std::array<std::size_t, kCellsPerPixel> cells{};
  for (std::size_t k = 0; k < cells.size(); ++k)
    cells[k] = static_cast<std::size_t>((row + kOutwards[k][0]) * side * kCells + column + kOutwards[k][1]);
  return cells;
}

std::uint8_t byte_of(float part) {
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(part, 0.0F, 1.0F)));
}

// Rounds values to compress well without visible loss: steps are a power of two, so that lower bits are zero.
constexpr double kWeightSteps = 65536;
double depth_step(double unit) { return std::exp2(std::floor(std::log2(unit)) - 15); }

Vec3f rounded_weights(const Vec3& weights) {
  Vec3 steps = (weights * kWeightSteps).array().round();
  Eigen::Index largest = 0;
  weights.maxCoeff(&largest);
  steps[largest] += kWeightSteps - steps.sum();
  return (steps / kWeightSteps).cast<float>();
}

Picture blank(const Camera& camera, const PictureOptions& options) {
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

std::vector<bool> visible_faces(const Seen& seen, std::size_t faces, const char* shape) {
  std::vector<bool> visible(faces, false);
  for (const std::int32_t face : seen.primitive)
    if (face >= 0) visible[index(face)] = true;
  if (std::ranges::find(visible, true) == visible.end())
    throw ShapeError(std::string("no pixel shows the ") + shape +
                     ": its surface has no area, or is seen edge-on");
  return visible;
}

// `points` are in eye space. The faces in `occluders`, the first of all faces, darken each other.
Picture taken(const Camera& camera, Points points, Surface faces, Surface occluders,
              const PictureOptions& options, const RandomSource& random, const char* shape) {
  const ImagePlane pixels{options.size, camera.tan_half_field()};
  const ImagePlane cells{options.size * kCells, camera.tan_half_field()};
  const Seen seen = see_faces(points, faces, cells);
  const CornerNormals normals(points, faces, visible_faces(seen, faces.size(), shape));
  const Lamp lamp(options);
  const double step = depth_step(camera.unit());
  Picture picture = blank(camera, options);
  std::vector<Site> sites(picture.pixels());
  std::vector<float> light(picture.pixels());
  for (std::size_t pixel = 0; pixel < picture.pixels(); ++pixel) {
    int count = 0;
    for (const std::size_t cell : cells_of(static_cast<int>(pixel), options.size)) {
      const std::int32_t face = seen.primitive[cell];
      if (face < 0) continue;
      const Vec3 ray = cells.ray_of_cell(static_cast<int>(cell));
      const Vec3 weights = weights_at(points, faces[index(face)], ray);
      // The visible side of a face decides, not the smooth normal, which may point away along an outline.
      const Vec3f& plane = normals.of_face(face);
      const float side = plane.dot(ray.cast<float>()) > 0 ? -1.0F : 1.0F;
      const Vec3f normal = side * normals.at(face, weights);
      light[pixel] += lamp.brightness(normal);
      if (count++ > 0) continue;
      const auto depth = static_cast<double>(seen.depth[cell]);
      picture.primitive[pixel] = face;
      picture.depth[pixel] = static_cast<float>(std::round(depth * camera.unit() / step) * step);
      const Vec3f rounded = rounded_weights(weights);
      std::ranges::copy(rounded, &picture.weights[3 * pixel]);
      if (index(face) < occluders.size())
        sites[pixel] = {true, (depth * ray).cast<float>(), normal, side * plane};
    }
    if (count > 0) light[pixel] /= static_cast<float>(count);
    picture.coverage[pixel] = byte_of(static_cast<float>(count) / kCellsPerPixel);
  }
  const std::vector<float> open =
      openness(embree::scene_of_triangles(points, occluders), sites, pixels, options, random.rng("picture"));
  const auto strength = static_cast<float>(options.occlusion_strength);
  for (std::size_t pixel = 0; pixel < picture.pixels(); ++pixel)
    if (picture.primitive[pixel] >= 0)
      picture.shade[pixel] = byte_of((1 - strength * (1 - open[pixel])) * light[pixel]);
  return picture;
}

std::vector<Vec3> in_eye_space(const Camera& camera, Points points) {
  std::vector<Vec3> places;
  for (const Vec3& p : points) places.push_back(camera.eye_from_world(p));
  return places;
}

// Squares in the planes of points: half as wide as kPart of the distance to the farthest of kAround
// neighbours, and for stray points no wider than for others.
constexpr std::size_t kAround = 6;  // as on an even surface
constexpr double kPart = 0.6;       // on a square grid, squares meet from 0.5 on
constexpr double kMostMedians = 4;

std::vector<double> half_widths(Points points) {
  const NearestPoints near = KdTree(points).nearest_of_each(points, std::min(kAround + 1, points.size()));
  std::vector<double> halves;
  for (std::size_t i = 0; i < points.size(); ++i)
    halves.push_back(kPart * std::sqrt(near.of(i).back().distance_squared));
  const double most = kMostMedians * upper_median(halves);
  for (double& half : halves) half = std::min(half, most);
  return halves;
}

// The partial mesh of points has holes, and points without a face: so each point has a square, which lies
// behind the mesh by half its width and takes no part in occlusion.
Picture points_taken(const Camera& camera, Points in_world, const Normals& normals, Surface surface,
                     const PictureOptions& options, const RandomSource& random, const char* shape) {
  CHECK_EQ(in_world.size(), normals.size());
  std::vector<Vec3> corners = in_eye_space(camera, in_world);
  Faces faces(surface.begin(), surface.end());
  std::vector<double> halves = half_widths(corners);
  for (std::size_t i = 0; i < in_world.size(); ++i) {
    halves[i] = std::min(halves[i], corners[i].z() / 2);  // in front of a near camera
    const Vec3 behind = corners[i] + halves[i] * corners[i].normalized();
    const Vec3 normal = camera.eye_from_world_direction(normals[i]);
    const Vec3 u = halves[i] * normal.unitOrthogonal(), v = normal.cross(u);
    const auto first = static_cast<std::int32_t>(corners.size());
    for (const Vec3& corner : {Vec3(u + v), Vec3(u - v), Vec3(-u - v), Vec3(v - u)})
      corners.push_back(behind + corner);
    faces.push_back({first, first + 1, first + 2});
    faces.push_back({first, first + 2, first + 3});
  }

  Picture picture = taken(camera, corners, faces, surface, options, random, shape);
  for (std::size_t pixel = 0; pixel < picture.pixels(); ++pixel) {
    if (picture.primitive[pixel] < 0) continue;
    const std::size_t face = index(picture.primitive[pixel]);
    float* weights = &picture.weights[3 * pixel];
    const auto nearest = static_cast<std::size_t>(std::max_element(weights, weights + 3) - weights);
    picture.primitive[pixel] = face < surface.size() ? surface[face][nearest]
                                                     : static_cast<std::int32_t>((face - surface.size()) / 2);
    std::copy_n(std::array{1.0F, 0.0F, 0.0F}.begin(), 3, weights);
  }
  return picture;
}

}  // namespace

Picture picture_of_mesh(const Mesh& mesh, const PictureOptions& options, const RandomSource& random) {
  std::vector<bool> used(mesh.vertices.size(), false);
  for (const Triangle& face : mesh.faces)
    for (const std::int32_t v : face) used[index(v)] = true;
  std::vector<Vec3> corners;
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i]) corners.push_back(mesh.vertices[i]);
  const Camera camera(corners, axes_for_mesh(upward(mesh, options), options), options, "mesh");
  return taken(camera, in_eye_space(camera, mesh.vertices), mesh.faces, mesh.faces, options, random, "mesh");
}

Picture picture_of_scan(const Scan& scan, const Normals& normals, Surface surface, const Mesh& mesh,
                        const PictureOptions& options, const RandomSource& random) {
  Vec3 centre = Vec3::Zero();
  for (const Vec3& p : scan.points) centre += p / static_cast<double>(scan.points.size());
  const CameraAxes axes = axes_for_scan(upward(mesh, options), scan.camera - centre, options);
  return points_taken({scan.points, axes, options, "scan"}, scan.points, normals, surface, options, random,
                      "scan");
}

Picture picture_of_cloud(const PointCloud& cloud, const Normals& normals, Surface surface,
                         const PictureOptions& options, const RandomSource& random) {
  Eigen::AlignedBox3d box;
  for (const Vec3& p : cloud.points) box.extend(p);
  const Vec3 up = upward(Mesh{cloud.points, {surface.begin(), surface.end()}}, options);
  const bool from_outside = cloud.viewpoint && !box.contains(*cloud.viewpoint);
  const CameraAxes axes =
      from_outside ? axes_for_scan(up, *cloud.viewpoint - box.center(), options) : axes_for_mesh(up, options);
  const char* shape = "point cloud";
  return points_taken({cloud.points, axes, options, shape}, cloud.points, normals, surface, options, random,
                      shape);
}

}  // namespace salbench
