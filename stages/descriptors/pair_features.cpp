// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/descriptors/pair_features.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "stages/descriptors/pair_features.cpp"
#include <hwy/foreach_target.h>  // must precede highway.h
#include <hwy/highway.h>

#ifndef SALBENCH_PAIR_LANES  // this file includes itself once per instruction set
#define SALBENCH_PAIR_LANES
namespace salbench {
namespace {

// Smaller differences are rounding errors, of doubles and (relative) of floats: the exact features then
// decide.
constexpr double kDoubt = 1e-10;
constexpr float kFloatDoubt = 1e-6F;

// Lower edges of the bins above the middle one, of 11 over [-1, 1]: 1/11, 3/11 ... 9/11.
constexpr std::array<float, kFilledBins - 1> kEdges = {1.F / 11, 3.F / 11, 5.F / 11, 7.F / 11, 9.F / 11};

struct Direction {
  float cosine, sine;
};
const std::array<Direction, kFilledBins - 1> kAngles = [] {
  std::array<Direction, kFilledBins - 1> angles{};
  for (std::size_t i = 0; i < angles.size(); ++i) {
    const double angle = static_cast<double>(2 * i + 1) / kBlockBins * std::numbers::pi;
    angles[i] = {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle))};
  }
  return angles;
}();

// Points and their normals, axis by axis.
struct Oriented {
  alignas(64) std::array<double, kPairs> x, y, z, nx, ny, nz;

  void set(std::size_t lane, const Vec3& point, const Vec3& normal) {
    x[lane] = point.x(), y[lane] = point.y(), z[lane] = point.z();
    nx[lane] = normal.x(), ny[lane] = normal.y(), nz[lane] = normal.z();
  }
};

// Number of edges that each feature reaches; doubtful: too close to an edge to decide.
struct Reached {
  alignas(64) std::array<std::int32_t, kPairs> theta, alpha, phi, both_ways, doubtful;
};

}  // namespace
}  // namespace salbench
#endif

HWY_BEFORE_NAMESPACE();
namespace salbench::HWY_NAMESPACE {
namespace {

HWY_INLINE double dot(double ax, double ay, double az, double bx, double by, double bz) {
  return ax * bx + ay * by + az * bz;  // in Eigen's order, so that the choice of the source agrees with it
}

// Plain loops over the lanes, which the compiler vectorises: in double to find source and target like Eigen,
// then in float to find the bins.
void look(const Vec3& p, const Vec3& n_p, const Oriented& q, bool swap, Reached& reached) {
  const double px = p.x(), py = p.y(), pz = p.z(), npx = n_p.x(), npy = n_p.y(), npz = n_p.z();
  alignas(64) std::array<float, kPairs> phis, alphas, sines, xs, ys;
  alignas(64) std::array<std::int64_t, kPairs> sure, both_ways;
  for (std::size_t lane = 0; lane < kPairs; ++lane) {
    const double nqx = q.nx[lane], nqy = q.ny[lane], nqz = q.nz[lane];
    double lx = q.x[lane] - px, ly = q.y[lane] - py, lz = q.z[lane] - pz;
    const double length = std::sqrt(lx * lx + ly * ly + lz * lz);
    lx /= length, ly /= length, lz /= length;
    const double slope_p = std::abs(dot(npx, npy, npz, lx, ly, lz));
    const double slope_q = std::abs(dot(nqx, nqy, nqz, lx, ly, lz));
    const bool swapped = swap & (slope_p < slope_q);
    const double ux = swapped ? nqx : npx, uy = swapped ? nqy : npy, uz = swapped ? nqz : npz;
    const double ox = swapped ? npx : nqx, oy = swapped ? npy : nqy, oz = swapped ? npz : nqz;

    // v times the sine of the angle between u and the line.
    const double vx = ly * uz - lz * uy, vy = lz * ux - lx * uz, vz = lx * uy - ly * ux;
    const double sine = std::sqrt(vx * vx + vy * vy + vz * vz);
    phis[lane] = static_cast<float>(swapped ? slope_q : slope_p);
    alphas[lane] = static_cast<float>(std::abs(dot(vx, vy, vz, ox, oy, oz)));
    sines[lane] = static_cast<float>(sine);
    xs[lane] = static_cast<float>(dot(ux, uy, uz, ox, oy, oz) * sine);
    ys[lane] = static_cast<float>(
        std::abs(dot(uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx, ox, oy, oz)));
    sure[lane] = sine >= kDoubt;
    const bool same_normal = (npx == nqx) & (npy == nqy) & (npz == nqz);
    both_ways[lane] = swap & ((slope_p != slope_q) | same_normal);
  }
  for (std::size_t lane = 0; lane < kPairs; ++lane) {
    const float alpha = alphas[lane], phi = phis[lane], x = xs[lane], y = ys[lane], sine = sines[lane];
    std::int32_t theta_edges = 0, alpha_edges = 0, phi_edges = 0,
                 certain = static_cast<std::int32_t>(sure[lane]);
    const float doubt = kFloatDoubt * sine;
    const float theta_doubt = kFloatDoubt * (std::abs(x) + y) + static_cast<float>(kDoubt) * sine;
    for (std::size_t edge = 0; edge < kEdges.size(); ++edge) {
      const float by_theta = y * kAngles[edge].cosine - x * kAngles[edge].sine;
      const float by_alpha = alpha - kEdges[edge] * sine, by_phi = phi - kEdges[edge];
      theta_edges += by_theta >= 0;
      alpha_edges += by_alpha >= 0;
      phi_edges += by_phi >= 0;
      certain &= std::abs(by_theta) > theta_doubt;
      certain &= std::abs(by_alpha) > doubt;
      certain &= std::abs(by_phi) > kFloatDoubt;
    }
    reached.theta[lane] = theta_edges;
    reached.alpha[lane] = alpha_edges;
    reached.phi[lane] = phi_edges;
    reached.both_ways[lane] = static_cast<std::int32_t>(both_ways[lane]);
    reached.doubtful[lane] = 1 - certain;
  }
}

}  // namespace
}  // namespace salbench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace salbench {
namespace {

std::uint8_t bin_of_magnitude(double value, double limit) {
  const double position = (std::abs(value) / limit + 1) / 2 * static_cast<double>(kBlockBins);
  return static_cast<std::uint8_t>(std::min(static_cast<std::size_t>(position), kBlockBins - 1) -
                                   kFirstFilled);
}

PairBins bins_of(const DarbouxTriple& pair, bool both_ways) {
  return {bin_of_magnitude(pair.theta, std::numbers::pi), bin_of_magnitude(pair.alpha, 1),
          bin_of_magnitude(pair.phi, 1), both_ways};
}

HWY_EXPORT(look);

}  // namespace

DarbouxTriple pair_features(const Vec3& p, const Vec3& n_p, const Vec3& q, const Vec3& n_q, bool swap) {
  Vec3 line = q - p;
  const double distance = line.norm();
  if (distance == 0) return {};
  line /= distance;
  const Vec3* u = &n_p;
  const Vec3* other = &n_q;
  if (swap && std::abs(n_p.dot(line)) < std::abs(n_q.dot(line))) {
    std::swap(u, other);
    line = -line;
  }
  // PCL has v = line x u instead of the paper's u x line, which changes only the signs of alpha and theta.
  Vec3 v = line.cross(*u);
  const double sine = v.norm();
  if (sine == 0) return {};
  v /= sine;
  return {v.dot(*other), u->dot(line), std::atan2(u->cross(v).dot(*other), u->dot(*other))};
}

PairBins pair_bins(const Vec3& p, const Vec3& n_p, const Vec3& q, const Vec3& n_q, bool swap) {
  constexpr std::int32_t kFirst = 0;
  std::array<PairBins, kPairs> bins;
  pair_bins(p, n_p, {&q, 1}, {&n_q, 1}, {&kFirst, 1}, swap, bins);
  return bins[0];
}

void pair_bins(const Vec3& p, const Vec3& n_p, std::span<const Vec3> points, std::span<const Vec3> normals,
               std::span<const std::int32_t> others, bool swap, std::array<PairBins, kPairs>& bins) {
  Oriented q;
  for (std::size_t lane = 0; lane < kPairs; ++lane) {  // unused lanes repeat the first
    const auto other = static_cast<std::size_t>(others[lane < others.size() ? lane : 0]);
    q.set(lane, points[other], normals[other]);
  }
  Reached reached;
  HWY_DYNAMIC_DISPATCH(look)(p, n_p, q, swap, reached);
  for (std::size_t lane = 0; lane < others.size(); ++lane) {
    const bool both_ways = reached.both_ways[lane] != 0;
    const auto other = static_cast<std::size_t>(others[lane]);
    bins[lane] = reached.doubtful[lane] != 0
                     ? bins_of(pair_features(p, n_p, points[other], normals[other], swap), both_ways)
                     : PairBins{static_cast<std::uint8_t>(reached.theta[lane]),
                                static_cast<std::uint8_t>(reached.alpha[lane]),
                                static_cast<std::uint8_t>(reached.phi[lane]), both_ways};
  }
}

}  // namespace salbench
#endif
