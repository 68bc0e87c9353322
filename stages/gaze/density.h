// SPDX-License-Identifier: GPL-3.0-or-later
// From the fixations of one participant to how densely they looked at each part of a shape: a Gaussian around
// each, as wide as what the fovea and the tracker's error cover, over the surface.
//
// Each fixation carries its mass wherever it falls and however the surface is meshed: its Gaussian is
// divided by its own integral. [lavoue2018] and others sum Gaussians on a screen, which then depend on how
// steeply a face is seen, or spread them in space, where they leak through thin parts. The error of a tracker
// is an angle at the eye, however steeply a face is seen: `view` integrates over a cone of rays.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string_view>

#include "stages/core/options.h"
#include "stages/gaze/hits.h"

namespace salbench {

struct LookedAt {
  FirstHit hit;             // depth: of the eye
  double mass = 1;          // as its duration
  Vec3 eye = Vec3::Zero();  // which `view` needs
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

// How densely people looked at one mesh.
class GazeDensity {
 public:
  // The mesh must outlive it.
  GazeDensity(const Mesh& mesh, const GazeDensityOptions& options);
  explicit GazeDensity(Mesh&&, const GazeDensityOptions&) = delete;
  ~GazeDensity();

  // n, per unit of area: its integral over the surface is 1, or it is 0 everywhere if no hit has a mass; NaN
  // at vertices without a face. Hits without a face do not count. Gaussians end at three standard deviations;
  // one that reaches no vertex is the corners of its face. Throws InputError for a face that the mesh does
  // not have, weights that are none, a mass or depth that is negative or not finite, or no eye where `view`
  // needs one: "fixation 17: ...",
  // counted from 1.
  ScalarField of(std::span<const LookedAt> fixations);

 private:
  const Mesh& mesh_;
  GazeDensityOptions options_;
  double fixed_ = 0;  // standard deviation; 0: by depth
  ScalarField areas_;
  std::unique_ptr<GazeReach> reach_;
};

// That of one person alone.
ScalarField gaze_density(const Mesh& mesh, std::span<const LookedAt> fixations,
                         const GazeDensityOptions& options = {});

}  // namespace salbench
