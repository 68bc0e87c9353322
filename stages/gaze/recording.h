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

// Fixations of each person. Those that the recording has are taken as they are, and hits without an eye as by
// the method `none`: how fast an eye turns that nobody knows cannot be said. A person whose samples have
// times that no eye tracker has gets none. Throws InputError that names person and sample, as fixations(), if
// all have such times, or if the mesh has no area.
GazeFixations fixations_of(const GazeRecording& recording, const Mesh& mesh, const FixationOptions& options);

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
  double fixated = 0, on_shape = 0;  // ms of all, and of those that are on it
};
std::vector<GazeCounts> counts_by_person(const GazeHits& hits);

// Which people count: who is left out, and by which rule, is to be reported [dunn2024].
struct GazePeopleOptions {
  double most_lost = 0.5;
  double least_seconds = 0.5;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(
        "most_lost", self.most_lost,
        {"people who lost more of their recording of a shape are left out there", "fraction", between(0, 1)});
    visit("least_seconds", self.least_seconds,
          {"people who were tracked on a shape for less are left out there", "s", at_least(0)});
  }
};

// By person, why they are left out: "lost 83 %"; empty for those who count. Where no time is known, everybody
// counts.
std::vector<std::string> left_out_people(const GazePeople& people, const GazePeopleOptions& options);

// One line that names who is left out, and why. Empty if nobody is.
std::string remark_on_left_out(const GazePeople& people, const GazePeopleOptions& options);

// One line on people whose fixations all miss the shape, last 0 ms, or hold less than half of the time that
// they were tracked. Empty if there are none.
std::string remark_on_people(const GazeHits& hits);

}  // namespace salbench
