// SPDX-License-Identifier: GPL-3.0-or-later
// Quadric error of a point, and the point that minimises it. [garland1997]
#pragma once

#include <algorithm>
#include <optional>

#include "stages/core/types.h"

namespace salbench {

// Sum of weighted squared distances to planes: x'Ax + 2b'x + c.
struct Quadric {
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Vec3 b = Vec3::Zero();
  double c = 0;

  void add_plane(const Vec3& normal, const Vec3& point, double weight) {
    const double d = -normal.dot(point);
    a += weight * normal * normal.transpose();
    b += weight * d * normal;
    c += weight * d * d;
  }
  Quadric& operator+=(const Quadric& other) {
    a += other.a;
    b += other.b;
    c += other.c;
    return *this;
  }
  double weight() const { return a.trace(); }  // over all planes
  double operator()(const Vec3& x) const { return std::max(0.0, x.dot(a * x) + 2 * b.dot(x) + c); }
};

// Point of least error. Along directions that the quadric leaves free, the one nearest to `near`.
Vec3 optimum(const Quadric& quadric, const Vec3& near);

// Lower bound close to the error at the optimum, found much faster; nullopt if a direction may be free.
std::optional<double> error_bound(const Quadric& quadric, const Vec3& near);

}  // namespace salbench
