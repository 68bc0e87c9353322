// SPDX-License-Identifier: GPL-3.0-or-later
// From one participant's fixations to gaze density on a shape: a Gaussian around each fixation, covering the
// fovea and the tracker's error, over the surface.
//
// Each fixation carries its mass regardless of its position and of the mesh: its Gaussian is divided by its
// own integral. [lavoue2018] and others sum Gaussians on the screen, which then depend on the viewing angle
// of a face, or spread them in space, where they leak through thin parts. A tracker's error is an angle at
// the eye, independent of the viewing angle of a face: `view` integrates over a cone of rays.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string_view>

#include "stages/core/options.h"
#include "stages/gaze/hits.h"

namespace salbench {

struct LookedAt {
  FirstHit hit;             // depth: distance from the eye
  double mass = 1;          // proportional to its duration
  Vec3 eye = Vec3::Zero();  // used by `view`
};

enum class Spread { geodesic, euclidean, view };
template <>
struct EnumNames<Spread> {
  static constexpr std::array<std::string_view, 3> names{"geodesic", "euclidean", "view"};
};

struct GazeDensityOptions {
  double degrees = 1;
  double radius = 0;
  Spread spread = Spread::geodesic;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("degrees", self.degrees,
          {"standard deviation of a fixation, as the eye sees it", "degrees", above_and_up_to(0, 45)});
    visit("radius", self.radius,
          {"standard deviation in place of `degrees`, the same from any distance; 0: `degrees`", "R",
           between(0, 2)});
    visit("spread", self.spread,
          {"distances over the surface, or straight through it; view: angles from the eye"});
  }
};

class GazeReach;

// Gaze density on one mesh.
class GazeDensity {
 public:
  // The mesh must outlive it.
  GazeDensity(const Mesh& mesh, const GazeDensityOptions& options);
  explicit GazeDensity(Mesh&&, const GazeDensityOptions&) = delete;
  ~GazeDensity();

  // n, per unit of area: its integral over the surface is 1, or it is 0 everywhere if no hit has a mass; NaN
  // at vertices without a face. Hits without a face are ignored. Gaussians end at three standard deviations;
  // one that reaches no vertex is distributed to the corners of its face. Throws InputError for an unknown
  // face, invalid weights, a mass or depth that is negative or not finite, or a missing eye if `view` needs
  // it: "fixation 17: ...", counted from 1.
  ScalarField of(std::span<const LookedAt> fixations);

 private:
  const Mesh& mesh_;
  GazeDensityOptions options_;
  double fixed_ = 0;  // standard deviation; 0: depends on depth
  ScalarField areas_;
  std::unique_ptr<GazeReach> reach_;
};

// Density of one person alone.
ScalarField gaze_density(const Mesh& mesh, std::span<const LookedAt> fixations,
                         const GazeDensityOptions& options = {});

}  // namespace salbench
