// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/core/embree.h"

#include <stdexcept>
#include <string>

namespace salbench::embree {
namespace {

// The only device of the process, never released. A second one, or a limit of one thread for this one, would
// change the thread pool of all other users. Pinned to one instruction set, for the same hits on every
// machine.
RTCDevice device() {
  static RTCDevice device = rtcNewDevice("isa=sse2");
  if (device == nullptr) throw std::runtime_error("Embree cannot be started");
  return device;
}

void check(const char* what) {
  if (rtcGetDeviceError(device()) != RTC_ERROR_NONE)
    throw std::runtime_error(std::string("Embree failed to ") + what);
}

template <class T>
T* new_buffer(const Geometry& geometry, RTCBufferType type, RTCFormat format, std::size_t width,
              std::size_t count) {
  void* buffer = rtcSetNewGeometryBuffer(geometry.get(), type, 0, format, width * sizeof(T), count);
  check("allocate the shape");
  return static_cast<T*>(buffer);
}

void append(float*& buffer, const Vec3& p) {
  for (const double x : p) *buffer++ = static_cast<float>(x);
}

}  // namespace

Geometry triangles(std::span<const Vec3> points, std::span<const Triangle> faces) {
  Geometry geometry(rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_TRIANGLE));
  auto* vertex = new_buffer<float>(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, 3, points.size());
  auto* index = new_buffer<std::uint32_t>(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, 3, faces.size());
  for (const Vec3& p : points) append(vertex, p);
  for (const Triangle& face : faces)
    for (const std::int32_t v : face) *index++ = static_cast<std::uint32_t>(v);
  rtcCommitGeometry(geometry.get());
  return geometry;
}

Geometry discs(std::span<const Vec3> points, std::span<const Vec3> normals, std::span<const double> radii) {
  Geometry geometry(rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT));
  auto* vertex = new_buffer<float>(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, 4, points.size());
  auto* normal = new_buffer<float>(geometry, RTC_BUFFER_TYPE_NORMAL, RTC_FORMAT_FLOAT3, 3, normals.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    append(vertex, points[i]);
    *vertex++ = static_cast<float>(radii[i]);
    append(normal, normals[i]);
  }
  rtcCommitGeometry(geometry.get());
  return geometry;
}

Scene scene_of(const Geometry& geometry, RTCSceneFlags further) {
  Scene scene(rtcNewScene(device()));
  // Without ROBUST, 3-4 % of the rays slip through between two faces.
  rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST | further);
  rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_LOW);  // few rays: building is most of the time
  rtcAttachGeometry(scene.get(), geometry.get());
  rtcCommitScene(scene.get());
  check("build the scene");
  return scene;
}

bool occluded(const Scene& scene, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float near,
              float far) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  alignas(16) RTCRay ray{};
  ray.org_x = origin.x();
  ray.org_y = origin.y();
  ray.org_z = origin.z();
  ray.dir_x = direction.x();
  ray.dir_y = direction.y();
  ray.dir_z = direction.z();
  ray.tnear = near;
  ray.tfar = far;
  ray.mask = ~0U;
  rtcOccluded1(scene.get(), &context, &ray);
  return ray.tfar < 0;
}

}  // namespace salbench::embree
