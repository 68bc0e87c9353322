// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <benchmark/benchmark.h>
#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include "stages/core/mesh_ops.h"
#include "stages/scan/scan.h"
#include "tests/perf/peers.h"

namespace salbench::peers {
namespace {

using Scene = std::unique_ptr<std::remove_pointer_t<RTCScene>, decltype(&rtcReleaseScene)>;
using Geometry = std::unique_ptr<std::remove_pointer_t<RTCGeometry>, decltype(&rtcReleaseGeometry)>;

RTCDevice device() {
  static RTCDevice device = rtcNewDevice(nullptr);
  if (device == nullptr) throw std::runtime_error("Embree cannot be started");
  return device;
}

struct Rays {
  Eigen::Vector3f origin;
  std::vector<Eigen::Vector3f> directions;
};

// The rays that simulate_scan() casts: the part of the grid that the mesh is seen in, and one ray more on
// each side.
Rays rays_of(const Mesh& mesh, int view) {
  const Vec3 camera = simulate_scan(mesh, view).camera;
  const Vec3 forward = (area_centroid(mesh) - camera).normalized();
  const Vec3 right = forward.cross(Vec3::UnitZ()).normalized(), up = right.cross(forward);
  const double step = std::tan(ScanOptions().step_degrees * std::numbers::pi / 180);
  Eigen::AlignedBox2d seen;
  for (const Vec3& p : mesh.vertices) {
    const Vec3 from_camera = p - camera;
    seen.extend(Eigen::Vector2d(from_camera.dot(right), from_camera.dot(up)) /
                (from_camera.dot(forward) * step));
  }
  const Eigen::Vector2i first = (seen.min().array().floor() - 1).cast<int>().matrix();
  const Eigen::Vector2i last = (seen.max().array().ceil() + 1).cast<int>().matrix();
  Rays rays{camera.cast<float>(), {}};
  for (int row = last.y(); row >= first.y(); --row)
    for (int column = first.x(); column <= last.x(); ++column)
      rays.directions.emplace_back((forward + column * step * right + row * step * up).cast<float>());
  return rays;
}

// Flags as those of our own scenes: without ROBUST, rays slip through between faces.
Scene scene_of(const std::vector<float>& vertices, const std::vector<Triangle>& faces) {
  const Geometry geometry(rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_TRIANGLE), rtcReleaseGeometry);
  rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices.data(), 0,
                             3 * sizeof(float), vertices.size() / 3);
  rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, faces.data(), 0,
                             sizeof(Triangle), faces.size());
  rtcCommitGeometry(geometry.get());
  Scene scene(rtcNewScene(device()), rtcReleaseScene);
  rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_LOW);
  rtcAttachGeometry(scene.get(), geometry.get());
  rtcCommitScene(scene.get());
  return scene;
}

void intersect(RTCScene scene, RTCRayHit& ray) {
#if RTC_VERSION_MAJOR >= 4
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  rtcIntersect1(scene, &ray, &arguments);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect1(scene, &context, &ray);
#endif
}

void cast(const Scene& scene, const Rays& rays, std::vector<Eigen::Vector3f>& hits) {
  for (const Eigen::Vector3f& direction : rays.directions) {
    alignas(16) RTCRayHit ray{};
    Eigen::Map<Eigen::Vector3f>(&ray.ray.org_x) = rays.origin;
    Eigen::Map<Eigen::Vector3f>(&ray.ray.dir_x) = direction;
    ray.ray.tfar = std::numeric_limits<float>::infinity();
    ray.ray.mask = ~0U;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    intersect(scene.get(), ray);
    if (ray.hit.geomID != RTC_INVALID_GEOMETRY_ID) hits.emplace_back(rays.origin + ray.ray.tfar * direction);
  }
}

}  // namespace

Work embree_scans(const Shape& shape, int views) {
  std::vector<float> vertices;
  for (const Vec3& p : shape.mesh.vertices)
    for (const double x : p) vertices.push_back(static_cast<float>(x));
  vertices.push_back(0);  // Embree reads the last vertex as four floats
  std::vector<Rays> rays;
  for (int view = 0; view < views; ++view) rays.push_back(rays_of(shape.mesh, view));
  return [&faces = shape.mesh.faces, vertices = std::move(vertices), rays = std::move(rays)] {
    const Scene scene = scene_of(vertices, faces);
    std::size_t count = 0;
    for (const Rays& of_view : rays) {
      std::vector<Eigen::Vector3f> hits;
      cast(scene, of_view, hits);
      benchmark::DoNotOptimize(hits);
      count += hits.size();
    }
    return count;
  };
}

}  // namespace salbench::peers
