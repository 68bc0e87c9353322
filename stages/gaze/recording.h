// SPDX-License-Identifier: GPL-3.0-or-later
// From recordings of all participants on one shape to their fixations, and where these are on it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "stages/core/gaze.h"
#include "stages/gaze/fixations.h"
#include "stages/gaze/hits.h"

namespace salbench {

// Fixations of each person. Those that the recording has are taken as they are, and hits without a duration
// as for the method `none`: how fast an eye turns that nobody knows cannot be said. Throws InputError that
// names person and sample, as fixations().
GazeFixations fixations_of(const GazeRecording& recording, const FixationOptions& options);

struct GazeHitOptions {
  HitOptions rays;
  double off = 0.05;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    HitOptions::fields(self.rays, visit);
    visit("off", self.off,
          {"a recorded place that is farther from the surface is no hit; others move to its nearest point",
           "R", between(0, 2)});
  }
};

// Throws InputError if the mesh has no area.
GazeHits hits_of(const Mesh& mesh, const GazeFixations& fixations, const GazeHitOptions& options);

// How many fixations one person made, how many of these are on the shape, and how many of those were moved
// onto it.
struct GazeCounts {
  std::int64_t fixations = 0, hits = 0, snapped = 0;
  double on_shape = 0;  // ms of all that are on it
};
std::vector<GazeCounts> counts_by_person(const GazeHits& hits);

// One line on people who count for nothing: all their fixations miss the shape, or last 0 ms. Empty if there
// are none.
std::string remark_on_people(const GazeHits& hits);

}  // namespace salbench
