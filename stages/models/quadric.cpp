// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/quadric.h"

#include <Eigen/Eigenvalues>

namespace salbench {
namespace {

constexpr double kMinStiffness = 1e-5;    // relative to the largest eigenvalue: less leaves a direction free
constexpr double kErrorRounding = 1e-14;  // error's rounding, relative to its largest terms; generous

// x of Ax = b by LDL', if no direction is free. The least eigenvalue is at most each pivot, and at least the
// determinant divided by the sum of the principal minors of order two.
std::optional<Vec3> solved(const Eigen::Matrix3d& a, const Vec3& b) {
  const double least = kMinStiffness * a.trace();
  const double d0 = a(0, 0), l10 = a(1, 0) / d0, l20 = a(2, 0) / d0;
  const double d1 = a(1, 1) - l10 * a(1, 0), rest = a(2, 1) - l10 * a(2, 0);
  if (!(d0 > least && d1 > least)) return {};
  const double l21 = rest / d1, d2 = a(2, 2) - l20 * a(2, 0) - l21 * rest;
  const double minors = d0 * (d1 + a(2, 2)) - a(2, 0) * a(2, 0) + a(1, 1) * a(2, 2) - a(2, 1) * a(2, 1);
  if (!(d0 * d1 * d2 > least * minors)) return {};
  const double y1 = b[1] - l10 * b[0], x2 = (b[2] - l20 * b[0] - l21 * y1) / d2, x1 = y1 / d1 - l21 * x2;
  return Vec3(b[0] / d0 - l10 * x1 - l20 * x2, x1, x2);
}

}  // namespace

Vec3 optimum(const Quadric& quadric, const Vec3& near) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(quadric.a);
  const Vec3 pull = -(quadric.b + quadric.a * near);
  Vec3 place = near;
  for (int k = 0; k < 3; ++k) {
    const double stiffness = axes.eigenvalues()[k];
    if (stiffness <= kMinStiffness * axes.eigenvalues()[2]) continue;
    const Vec3 axis = axes.eigenvectors().col(k);
    place += axis * (axis.dot(pull) / stiffness);
  }
  return place;
}

std::optional<double> error_bound(const Quadric& quadric, const Vec3& near) {
  const auto move = solved(quadric.a, -(quadric.b + quadric.a * near));
  if (!move) return {};
  const Vec3 place = near + *move;
  const double largest_terms = 2 * (quadric.weight() * place.squaredNorm() + quadric.c);
  return quadric(place) - kErrorRounding * largest_terms;
}

}  // namespace salbench
