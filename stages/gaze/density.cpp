// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/gaze/density.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "stages/core/errors.h"
#include "stages/geometry/first_hit.h"
#include "stages/geometry/mesh_ops.h"
#include "stages/geometry/neighbours.h"
#include "stages/geometry/surface_distances.h"

namespace salbench {
namespace {

constexpr double kReach = 3;  // standard deviations

void check_fixations(const Mesh& mesh, std::span<const LookedAt> fixations,
                     const GazeDensityOptions& options) {
  const bool by_depth = options.radius == 0 || options.spread == Spread::view;
  for (std::size_t i = 0; i < fixations.size(); ++i) {
    const auto& [hit, mass, eye] = fixations[i];
    const auto refuse = [&](const std::string& wrong) {
      throw ShapeError(fmt::format("fixation {}: {}", i + 1, wrong));
    };
    if (!std::isfinite(mass) || mass < 0) refuse(fmt::format("its mass is {}", mass));
    if (!hit) continue;
    if (hit.face >= mesh.faces.size())
      refuse(fmt::format("there is no face {} of {}", hit.face, mesh.faces.size()));
    if (!(hit.weights.minCoeff() >= 0) || !(std::abs(hit.weights.sum() - 1) <= 1e-6))
      refuse("its weights are not three numbers >= 0 with a sum of 1");
    if (options.spread == Spread::view && !eye.allFinite())
      refuse("the place of its eye is not known: set `spread` to geodesic, and `radius`");
    if (by_depth && (!std::isfinite(hit.depth) || hit.depth < 0))
      refuse("its distance from the eye is not known: set `radius` in place of `degrees`");
  }
}

double gaussian(double scaled) { return std::exp(-scaled * scaled / 2); }

}  // namespace

// Share of a fixation that each point within reach receives, up to a factor, in an order determined by the
// mesh.
class GazeReach {
 public:
  struct Share {
    std::int32_t index;
    double share;
  };
  virtual ~GazeReach() = default;
  // sigma: length at the depth of the hit.
  virtual std::span<const Share> of(const LookedAt& fixation, double sigma) = 0;
};

namespace {

// Areas of vertices, weighted by distance over the surface or through space.
class Lengths : public GazeReach {
 public:
  Lengths(const Mesh& mesh, const ScalarField& areas, Spread spread) : mesh_(mesh), areas_(areas) {
    if (spread == Spread::geodesic)
      over_.emplace(mesh.vertices, mesh.faces);
    else
      through_.emplace(mesh.vertices);
  }

  std::span<const Share> of(const LookedAt& fixation, double sigma) override {
    const FirstHit& hit = fixation.hit;
    shares_.clear();
    const auto add = [&](std::int32_t vertex, double distance) {
      shares_.push_back({vertex, areas_[index(vertex)] * gaussian(distance / sigma)});
    };
    if (over_) {
      for (const auto& [vertex, distance] : over_->from(hit.face, hit.weights, kReach * sigma))
        add(vertex, distance);
    } else {
      through_->within(hit.point_in(mesh_), kReach * sigma, found_);
      for (const Neighbour& found : found_) add(found.index, std::sqrt(found.distance_squared));
    }
    return shares_;
  }

 private:
  const Mesh& mesh_;
  const ScalarField& areas_;
  std::optional<SurfaceDistances> over_;
  std::optional<KdTree> through_;
  std::vector<Neighbour> found_;
  std::vector<Share> shares_;
};

// Solid angles of visible vertices, weighted by their angle to the gaze direction.
class Angles : public GazeReach {
 public:
  explicit Angles(const Mesh& mesh)
      : mesh_(mesh),
        traced_(mesh),
        near_(1e-6 * bounding_radius(mesh.vertices)),
        solid_(mesh.vertices.size()) {}

  std::span<const Share> of(const LookedAt& fixation, double sigma) override {
    const Vec3 ahead = (fixation.hit.point_in(mesh_) - fixation.eye).normalized();
    const double width = std::atan(sigma / fixation.hit.depth);
    find_seen(fixation.eye, ahead, std::cos(std::min(kReach * width, std::numbers::pi)));
    add_solid_angles(fixation.eye);
    shares_.clear();
    for (const std::int32_t vertex : seen_) {
      const Vec3 way = mesh_.vertices[index(vertex)] - fixation.eye;
      const double angle = std::atan2(way.cross(ahead).norm(), way.dot(ahead));
      shares_.push_back({vertex, solid_[index(vertex)] * gaussian(angle / width)});
      solid_[index(vertex)] = 0;
    }
    return shares_;
  }

 private:
  void find_seen(const Vec3& eye, const Vec3& ahead, double least_cosine) {
    seen_.clear();
    for (std::size_t v = 0; v < mesh_.vertices.size(); ++v) {
      const Vec3 way = mesh_.vertices[v] - eye;
      const double distance = way.norm();
      if (way.dot(ahead) < least_cosine * distance || !(distance > near_)) continue;
      if (traced_.first_hit(eye, way / distance).depth >= distance - near_)
        seen_.push_back(static_cast<std::int32_t>(v));
    }
    is_seen_.assign(mesh_.vertices.size(), false);
    for (const std::int32_t vertex : seen_) is_seen_[index(vertex)] = true;
  }

  // Adds a third of each face's solid angle to its corners.
  void add_solid_angles(const Vec3& eye) {
    for (const Triangle& face : mesh_.faces) {
      if (std::ranges::none_of(face, [&](std::int32_t corner) { return is_seen_[index(corner)]; })) continue;
      const auto& [a, b, c] = face;
      const Vec3 way = (at(mesh_.vertices, a) + at(mesh_.vertices, b) + at(mesh_.vertices, c)) / 3 - eye;
      const double distance = way.norm();
      if (!(distance > near_)) continue;
      const double seen = std::abs(face_area_vector(mesh_, face).dot(way)) / (distance * distance * distance);
      for (const std::int32_t corner : face)
        if (is_seen_[index(corner)]) solid_[index(corner)] += seen / 3;
    }
  }

  const Mesh& mesh_;
  TracedMesh traced_;
  double near_;  // tolerance of a ray to a vertex
  ScalarField solid_;
  std::vector<bool> is_seen_;
  std::vector<std::int32_t> seen_;
  std::vector<Share> shares_;
};

}  // namespace

GazeDensity::GazeDensity(const Mesh& mesh, const GazeDensityOptions& options)
    : mesh_(mesh),
      options_(options),
      fixed_(options.radius == 0 ? 0 : options.radius * bounding_radius(mesh.vertices)),
      areas_(barycentric_areas(mesh.vertices, mesh.faces)) {
  if (options.spread == Spread::view)
    reach_ = std::make_unique<Angles>(mesh);
  else
    reach_ = std::make_unique<Lengths>(mesh, areas_, options.spread);
}
GazeDensity::~GazeDensity() = default;

ScalarField GazeDensity::of(std::span<const LookedAt> fixations) {
  check_fixations(mesh_, fixations, options_);
  const double tangent = std::tan(options_.degrees * kRadiansPerDegree);
  ScalarField mass_at(mesh_.vertices.size(), 0);
  double total = 0;
  for (const LookedAt& fixation : fixations) {
    const auto& [hit, mass, eye] = fixation;
    if (!hit || mass == 0) continue;
    const auto shares = reach_->of(fixation, fixed_ > 0 ? fixed_ : hit.depth * tangent);
    double sum = 0;
    for (const GazeReach::Share& reached : shares) sum += reached.share;
    total += mass;
    if (sum > 0)
      for (const auto& [vertex, share] : shares) mass_at[index(vertex)] += mass * share / sum;
    else
      for (std::size_t k = 0; k < 3; ++k)
        mass_at[index(mesh_.faces[hit.face][k])] += mass * hit.weights[static_cast<Eigen::Index>(k)];
  }
  for (std::size_t v = 0; v < mass_at.size(); ++v)
    if (!(areas_[v] > 0))
      mass_at[v] = std::numeric_limits<double>::quiet_NaN();
    else if (total > 0)
      mass_at[v] = mass_at[v] / areas_[v] / total;
  return mass_at;
}

ScalarField gaze_density(const Mesh& mesh, std::span<const LookedAt> fixations,
                         const GazeDensityOptions& options) {
  return GazeDensity(mesh, options).of(fixations);
}

}  // namespace salbench
