// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/picture/camera.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "stages/core/errors.h"
#include "stages/geometry/mesh_ops.h"

namespace salbench {
namespace {

// Front of an upright shape, as for most of the benchmark's: shapes along y face +z, those along z face +y.
Vec3 front_of(const Vec3& up) { return up.y() > 0 ? Vec3::UnitZ() : Vec3::UnitY(); }

CameraAxes axes_towards(const Vec3& back, const Vec3& up) {
  CameraAxes axes{up.cross(back).normalized(), {}, back};
  axes.up = axes.back.cross(axes.right);
  return axes;
}

Vec3 turned(const Vec3& direction, double degrees, const Vec3& axis) {
  return Eigen::AngleAxisd(degrees * kRadiansPerDegree, axis) * direction;
}

// Plausibility of a mesh standing on this axis: the surface area that the camera then sees, from either side
// and through other faces, and its height. Found by inspecting two of each of the benchmark's classes: the
// area alone lays chairs on their sides, the height alone people.
double standing(const Mesh& mesh, const Vec3& up, const PictureOptions& options) {
  const Vec3 direction = axes_for_mesh(up, options).back;
  double area = 0;
  Eigen::AlignedBox1d heights;
  for (const Triangle& face : mesh.faces) {
    area += std::abs(face_area_vector(mesh, face).dot(direction));
    for (const std::int32_t v : face)
      heights.extend(Eigen::Matrix<double, 1, 1>(mesh.vertices[static_cast<std::size_t>(v)].dot(up)));
  }
  return area * std::sqrt(heights.sizes()[0]);
}

}  // namespace

Vec3 upward(const Mesh& mesh, const PictureOptions& options) {
  if (options.up != PictureUp::automatic) return options.up == PictureUp::y ? Vec3::UnitY() : Vec3::UnitZ();
  const bool along_z = standing(mesh, Vec3::UnitZ(), options) > standing(mesh, Vec3::UnitY(), options);
  return along_z ? Vec3::UnitZ() : Vec3::UnitY();
}

CameraAxes axes_for_mesh(const Vec3& up, const PictureOptions& options) {
  const Vec3 horizontal = turned(front_of(up), options.azimuth, up);
  return axes_towards(turned(horizontal, -options.elevation, up.cross(horizontal)), up);
}

CameraAxes axes_for_scan(const Vec3& up, const Vec3& towards_scanner, const PictureOptions& options) {
  const Vec3 back = turned(towards_scanner.normalized(), options.scan_turn, up);
  const bool vertical = std::abs(back.dot(up)) > 0.99;
  return axes_towards(back, vertical ? front_of(up) : up);
}

// Nearest of all cameras with these axes that see every point. To see a point at (x, y, z) from (px, py, d),
// where z grows towards the camera: |x - px| <= (d - z) t, so d t + px >= x + z t and d t - px >= -x + z t.
Camera::Camera(std::span<const Vec3> points, const CameraAxes& axes, const PictureOptions& options,
               const char* shape)
    : axes_(axes), tan_half_(std::tan(options.field_of_view / 2 * kRadiansPerDegree)) {
  if (points.empty()) throw ShapeError(fmt::format("the {} is empty: there is nothing to see", shape));
  if (const std::string wrong = wrong_with_extent(points); !wrong.empty())
    throw ShapeError(fmt::format("the {}: {}", shape, wrong));
  Eigen::AlignedBox3d box;
  for (const Vec3& p : points) box.extend(p);
  centre_ = box.center();
  unit_ = 0;
  for (const Vec3& p : points) unit_ = std::max(unit_, (p - centre_).norm());

  const double t = tan_half_ * (1 - 2 * options.margin);
  position_.setZero();
  Vec3 least = Vec3::Constant(-std::numeric_limits<double>::infinity());  // d t + px, d t - px; d
  Vec3 others = least;
  for (const Vec3& p : points) {
    const Vec3 at = (p - centre_) / unit_;
    const double x = at.dot(axes_.right), y = at.dot(axes_.up), z = at.dot(axes_.back);
    least = least.cwiseMax(Vec3(x + z * t, y + z * t, z));
    others = others.cwiseMax(Vec3(-x + z * t, -y + z * t, z));
  }
  const Vec3 sums = least + others;
  constexpr double kNearest = 1e-3;  // also for a line that points at the camera
  const double distance = std::max({sums.x() / (2 * t), sums.y() / (2 * t), least.z() + kNearest});
  position_ = {(least.x() - others.x()) / 2, (least.y() - others.y()) / 2, distance};
}

Vec3 Camera::eye_from_world(const Vec3& point) const {
  const Vec3 at = (point - centre_) / unit_;
  return {at.dot(axes_.right) - position_.x(), at.dot(axes_.up) - position_.y(),
          position_.z() - at.dot(axes_.back)};
}

Vec3 Camera::eye_from_world_direction(const Vec3& direction) const {
  return {direction.dot(axes_.right), direction.dot(axes_.up), -direction.dot(axes_.back)};
}

// The third component of clip space maps the range from the shape's nearest to its farthest point to -w .. w,
// as in OpenGL.
std::array<double, 16> Camera::view_projection() const {
  Eigen::Matrix4d eye = Eigen::Matrix4d::Identity();  // mesh unit; z away from the camera
  const Vec3 rows[] = {axes_.right, axes_.up, -axes_.back};
  const Vec3 shift(position_.x(), position_.y(), -position_.z());
  for (int i = 0; i < 3; ++i) {
    eye.block<1, 3>(i, 0) = rows[i].transpose();
    eye(i, 3) = -rows[i].dot(centre_) - unit_ * shift[i];
  }
  const double near = std::max(position_.z() - 1, 1e-3 * position_.z()) * unit_;
  const double far = (position_.z() + 1) * unit_;
  Eigen::Matrix4d projection = Eigen::Matrix4d::Zero();
  projection(0, 0) = projection(1, 1) = 1 / tan_half_;
  projection(2, 2) = (far + near) / (far - near);
  projection(2, 3) = -2 * far * near / (far - near);
  projection(3, 2) = 1;
  const Eigen::Matrix4d product = projection * eye;
  std::array<double, 16> flat{};
  for (int i = 0; i < 16; ++i) flat[static_cast<std::size_t>(i)] = product(i / 4, i % 4);
  return flat;
}

}  // namespace salbench
