// SPDX-License-Identifier: GPL-3.0-or-later
// Embree 4 moved the filter and flags of a query's context to "arguments", which may be absent.
#include "stages/geometry/embree.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>
#include <type_traits>

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace salbench::embree {
namespace {

#if RTC_VERSION_MAJOR >= 4
using Context = RTCRayQueryContext;
constexpr RTCSceneFlags kFiltered = RTC_SCENE_FLAG_FILTER_FUNCTION_IN_ARGUMENTS;

void intersect(RTCScene scene, Context& context, RTCFilterFunctionN filter, RTCRayHit& ray) {
  rtcInitRayQueryContext(&context);
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER;
  arguments.context = &context;
  arguments.filter = filter;
  rtcIntersect1(scene, &ray, &arguments);
}

void occlude(RTCScene scene, RTCRay& ray) { rtcOccluded1(scene, &ray); }
#else
using Context = RTCIntersectContext;
constexpr RTCSceneFlags kFiltered = RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION;

void intersect(RTCScene scene, Context& context, RTCFilterFunctionN filter, RTCRayHit& ray) {
  rtcInitIntersectContext(&context);
  context.filter = filter;
  rtcIntersect1(scene, &context, &ray);
}

void occlude(RTCScene scene, RTCRay& ray) {
  Context context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene, &context, &ray);
}
#endif

// The only device of the process, never released: a second one, or a limit of one thread for this one, would
// change the thread pool of all other users. Pinned to one instruction set, so that every machine gets equal
// hits.
RTCDevice device() {
  static RTCDevice device = rtcNewDevice("isa=sse2");
  if (device == nullptr) throw std::runtime_error("Embree cannot be started");
  return device;
}

void check(const char* what) {
  if (rtcGetDeviceError(device()) != RTC_ERROR_NONE)
    throw std::runtime_error(std::string("Embree failed to ") + what);
}

using Geometry = std::unique_ptr<std::remove_pointer_t<RTCGeometry>, decltype(&rtcReleaseGeometry)>;

Geometry new_geometry(RTCGeometryType type) { return {rtcNewGeometry(device(), type), rtcReleaseGeometry}; }

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

Scene scene_of(const Geometry& geometry) {
  rtcCommitGeometry(geometry.get());
  Scene scene(rtcNewScene(device()));
  // Without ROBUST, 3-4 % of the rays pass between adjacent faces.
  rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST | kFiltered);
  rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_LOW);  // few rays: the build takes most of the time
  rtcAttachGeometry(scene.get(), geometry.get());
  rtcCommitScene(scene.get());
  check("build the scene");
  return scene;
}

RTCRay ray_of(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float near, float far) {
  RTCRay ray{};
  ray.org_x = origin.x();
  ray.org_y = origin.y();
  ray.org_z = origin.z();
  ray.dir_x = direction.x();
  ray.dir_y = direction.y();
  ray.dir_z = direction.z();
  ray.tnear = near;
  ray.tfar = far;
  ray.mask = ~0U;
  return ray;
}

// Embree passes the context to the filter.
struct Noting : Context {
  std::vector<Hit>& hits;
  float margin;
  float limit;  // largest depth
};

// N is 1: each call traces a single ray.
void note_and_cut(const RTCFilterFunctionNArguments* arguments) {
  auto& noting = *static_cast<Noting*>(arguments->context);
  float& depth = RTCRayN_tfar(arguments->ray, 1, 0);
  noting.hits.push_back({RTCHitN_primID(arguments->hit, 1, 0), depth});
  noting.limit = std::min(noting.limit, depth + noting.margin);
  depth = noting.limit;  // limit for the rest of Embree's search
}

}  // namespace

void Release::operator()(RTCSceneTy* scene) const { rtcReleaseScene(scene); }

Scene scene_of_triangles(std::span<const Vec3> points, std::span<const Triangle> faces) {
  const Geometry geometry = new_geometry(RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertex = new_buffer<float>(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, 3, points.size());
  auto* index = new_buffer<std::uint32_t>(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, 3, faces.size());
  for (const Vec3& p : points) append(vertex, p);
  for (const Triangle& face : faces)
    for (const std::int32_t v : face) *index++ = static_cast<std::uint32_t>(v);
  return scene_of(geometry);
}

Scene scene_of_discs(std::span<const Vec3> points, std::span<const Vec3> normals,
                     std::span<const double> radii) {
  const Geometry geometry = new_geometry(RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT);
  auto* vertex = new_buffer<float>(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, 4, points.size());
  auto* normal = new_buffer<float>(geometry, RTC_BUFFER_TYPE_NORMAL, RTC_FORMAT_FLOAT3, 3, normals.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    append(vertex, points[i]);
    *vertex++ = static_cast<float>(radii[i]);
    append(normal, normals[i]);
  }
  return scene_of(geometry);
}

bool occluded(const Scene& scene, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float near,
              float far) {
  alignas(16) RTCRay ray = ray_of(origin, direction, near, far);
  occlude(scene.get(), ray);
  return ray.tfar < 0;
}

float append_hits(const Scene& scene, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction,
                  float margin, std::vector<Hit>& hits) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  alignas(16) RTCRayHit ray{ray_of(origin, direction, 0, kInfinity), {}};
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  Noting noting{{}, hits, margin, kInfinity};
  intersect(scene.get(), noting, note_and_cut, ray);
  return noting.limit;
}

void visit_near(const Scene& scene, const Eigen::Vector3f& place, float radius,
                const std::function<float(std::uint32_t face)>& visit) {
  RTCPointQuery query{place.x(), place.y(), place.z(), 0, radius};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  const auto visit_and_shrink = [](RTCPointQueryFunctionArguments* arguments) {
    const auto& next = *static_cast<const std::function<float(std::uint32_t)>*>(arguments->userPtr);
    const float smaller = next(arguments->primID);
    if (!(smaller < arguments->query->radius)) return false;
    arguments->query->radius = smaller;
    return true;
  };
  rtcPointQuery(scene.get(), &query, &context, visit_and_shrink,
                const_cast<std::function<float(std::uint32_t)>*>(&visit));
}

const char* version() { return RTC_VERSION_STRING; }

}  // namespace salbench::embree
