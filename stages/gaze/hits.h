// SPDX-License-Identifier: GPL-3.0-or-later
// Gaze position on a shape: first intersection of the gaze direction with a face, from either side.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "stages/core/options.h"
#include "stages/core/types.h"
#include "stages/geometry/first_hit.h"

namespace salbench {

struct GazeRay {
  Vec3 origin = Vec3::Zero(), direction = Vec3::UnitZ();  // in the frame of the shape
};

struct HitOptions {
  double snap = 0;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("snap", self.snap,
          {"a ray that misses the shape by no more takes the nearest direction that meets it", "degrees",
           between(0, 90)});
  }
};

struct GazeHit : FirstHit {  // depth: distance from the eye, in the unit of the shape
  bool snapped = false;
};

// One per ray; without a face if it misses. Throws InputError if the mesh has no area, and for the first ray
// that is not finite or has no direction: "ray 17: ...", counted from 1.
std::vector<GazeHit> gaze_hits(const Mesh& mesh, std::span<const GazeRay> rays,
                               const HitOptions& options = {});

}  // namespace salbench
