// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/core/pair_features.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace salbench {
namespace {

// Differences below this are rounding: the features themselves decide then.
constexpr double kDoubt = 1e-10;

// Lower edges of the bins above the middle one, of 11 over [-1, 1]: 1/11, 3/11 ... 9/11.
constexpr std::array<double, kFilledBins - 1> kEdges = {1. / 11, 3. / 11, 5. / 11, 7. / 11, 9. / 11};

struct Direction {
  double cosine, sine;
};
const std::array<Direction, kFilledBins - 1> kAngles = [] {
  std::array<Direction, kFilledBins - 1> angles{};
  for (std::size_t i = 0; i < angles.size(); ++i)
    angles[i] = {std::cos(kEdges[i] * std::numbers::pi), std::sin(kEdges[i] * std::numbers::pi)};
  return angles;
}();

std::uint8_t bin_of_magnitude(double value, double limit) {
  const double position = (std::abs(value) / limit + 1) / 2 * static_cast<double>(kBlockBins);
  return static_cast<std::uint8_t>(std::min(static_cast<std::size_t>(position), kBlockBins - 1) -
                                   kFirstFilled);
}

PairBins bins_of(const DarbouxTriple& pair, bool both_ways) {
  return {bin_of_magnitude(pair.theta, std::numbers::pi), bin_of_magnitude(pair.alpha, 1),
          bin_of_magnitude(pair.phi, 1), both_ways};
}

// How many edges a value reaches, and whether it is too near to one to tell.
struct Reached {
  std::uint8_t edges = 0;
  bool doubtful = false;

  void compare(double beyond, double scale) {
    edges = static_cast<std::uint8_t>(edges + (beyond >= 0));
    doubtful |= !(std::abs(beyond) > kDoubt * scale);
  }
};

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
  // PCL has v = line x u where the paper has u x line: only the signs of alpha and theta depend on it.
  Vec3 v = line.cross(*u);
  const double sine = v.norm();
  if (sine == 0) return {};
  v /= sine;
  return {v.dot(*other), u->dot(line), std::atan2(u->cross(v).dot(*other), u->dot(*other))};
}

PairBins pair_bins(const Vec3& p, const Vec3& n_p, const Vec3& q, const Vec3& n_q, bool swap) {
  Vec3 line = q - p;
  line /= line.norm();  // as there: which point is the source has to be decided alike
  const double slope_p = std::abs(n_p.dot(line)), slope_q = std::abs(n_q.dot(line));
  const bool both_ways = swap && (slope_p != slope_q || n_p == n_q);
  const bool swapped = swap && slope_p < slope_q;
  const Vec3& u = swapped ? n_q : n_p;
  const Vec3& other = swapped ? n_p : n_q;

  const Vec3 across = line.cross(u);  // v times the sine of the angle between u and the line
  const double sine = across.norm();
  const double alpha = std::abs(across.dot(other)), phi = swapped ? slope_q : slope_p;
  const double x = u.dot(other) * sine, y = std::abs(u.cross(across).dot(other));
  Reached by_theta, by_alpha, by_phi;
  for (std::size_t edge = 0; edge < kEdges.size(); ++edge) {
    by_theta.compare(y * kAngles[edge].cosine - x * kAngles[edge].sine, sine);
    by_alpha.compare(alpha - kEdges[edge] * sine, sine);
    by_phi.compare(phi - kEdges[edge], 1);
  }
  if (by_theta.doubtful || by_alpha.doubtful || by_phi.doubtful || sine < kDoubt)
    return bins_of(pair_features(p, n_p, q, n_q, swap), both_ways);
  return {by_theta.edges, by_alpha.edges, by_phi.edges, both_ways};
}

}  // namespace salbench
