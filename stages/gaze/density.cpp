// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/gaze/density.h"

#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "stages/core/errors.h"
#include "stages/geometry/mesh_ops.h"
#include "stages/geometry/neighbours.h"
#include "stages/geometry/surface_distances.h"

namespace salbench {
namespace {

constexpr double kReach = 3;  // standard deviations

void check_fixations(const Mesh& mesh, std::span<const LookedAt> fixations, bool by_depth) {
  for (std::size_t i = 0; i < fixations.size(); ++i) {
    const auto& [hit, mass] = fixations[i];
    const auto refuse = [&](const std::string& wrong) {
      throw ShapeError(fmt::format("fixation {}: {}", i + 1, wrong));
    };
    if (!std::isfinite(mass) || mass < 0) refuse(fmt::format("its mass is {}", mass));
    if (!hit) continue;
    if (hit.face >= mesh.faces.size())
      refuse(fmt::format("there is no face {} of {}", hit.face, mesh.faces.size()));
    if (!(hit.weights.minCoeff() >= 0) || !(std::abs(hit.weights.sum() - 1) <= 1e-6))
      refuse("its weights are not three numbers >= 0 with a sum of 1");
    if (by_depth && (!std::isfinite(hit.depth) || hit.depth < 0))
      refuse("its distance from the eye is not known: set `radius` in place of `degrees`");
  }
}

}  // namespace

// The points within reach of a hit, in an order that depends on the mesh alone.
class GazeDensity::Reach {
 public:
  Reach(const Mesh& mesh, Spread spread) : mesh_(mesh) {
    if (spread == Spread::geodesic)
      over_.emplace(mesh.vertices, mesh.faces);
    else
      through_.emplace(mesh.vertices);
  }

  std::span<const ReachedPoint> of(const FirstHit& hit, double reach) {
    if (over_) return over_->from(hit.face, hit.weights, reach);
    through_->within(hit.point_in(mesh_), reach, found_);
    reached_.clear();
    for (const Neighbour& found : found_)
      reached_.push_back({found.index, std::sqrt(found.distance_squared)});
    return reached_;
  }

 private:
  const Mesh& mesh_;
  std::optional<SurfaceDistances> over_;
  std::optional<KdTree> through_;
  std::vector<Neighbour> found_;
  std::vector<ReachedPoint> reached_;
};

GazeDensity::GazeDensity(const Mesh& mesh, const GazeDensityOptions& options)
    : mesh_(mesh),
      options_(options),
      fixed_(options.radius == 0 ? 0 : options.radius * bounding_radius(mesh.vertices)),
      areas_(barycentric_areas(mesh.vertices, mesh.faces)),
      reach_(std::make_unique<Reach>(mesh, options.spread)) {}
GazeDensity::~GazeDensity() = default;

ScalarField GazeDensity::of(std::span<const LookedAt> fixations) {
  check_fixations(mesh_, fixations, options_.radius == 0);
  const double tangent = std::tan(options_.degrees * kRadiansPerDegree);
  ScalarField mass_at(mesh_.vertices.size(), 0);
  double total = 0;
  std::vector<double> kernel;
  for (const auto& [hit, mass] : fixations) {
    if (!hit || mass == 0) continue;
    const double sigma = fixed_ > 0 ? fixed_ : hit.depth * tangent;
    const auto reached = reach_->of(hit, kReach * sigma);
    kernel.clear();
    double sum = 0;
    for (const auto& [vertex, distance] : reached) {
      const double scaled = distance / sigma;
      kernel.push_back(areas_[index(vertex)] * std::exp(-scaled * scaled / 2));
      sum += kernel.back();
    }
    total += mass;
    if (sum > 0)
      for (std::size_t k = 0; k < reached.size(); ++k)
        mass_at[index(reached[k].index)] += mass * kernel[k] / sum;
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
