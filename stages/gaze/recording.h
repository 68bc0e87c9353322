// SPDX-License-Identifier: GPL-3.0-or-later
// From gaze recordings of all participants on one shape to fixations and their positions on it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "stages/core/gaze.h"
#include "stages/gaze/fixations.h"
#include "stages/gaze/hits.h"

namespace salbench {

// Fixations of each person. Recorded fixations are taken as they are; hits without an eye are handled as by
// the method `none`, since the angular velocity of the eye is unknown. A person whose sampling times no eye
// tracker has gets no fixations. Throws InputError that names person and sample, like fixations(), if all
// have such times, or if the mesh has no area.
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

// Number of a person's fixations, of those on the shape, and of those that were moved onto it.
struct GazeCounts {
  std::int64_t fixations = 0, hits = 0, snapped = 0;
  double fixated = 0, on_shape = 0;  // ms of all fixations, and of those on the shape
};
std::vector<GazeCounts> counts_by_person(const GazeHits& hits);

// Criteria for excluding people; exclusions and criteria have to be reported [dunn2024].
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

// Reason of exclusion per person: "lost 83 %"; empty if included. Without times, everybody is included.
std::vector<std::string> left_out_people(const GazePeople& people, const GazePeopleOptions& options);

// One line that names the excluded people and the reasons; empty if there are none.
std::string remark_on_left_out(const GazePeople& people, const GazePeopleOptions& options);

// One line on people whose fixations all miss the shape, come from inside it, last 0 ms, or cover less than
// half of their tracked time; empty if there are none.
std::string remark_on_people(const GazeHits& hits, const Mesh& mesh);

}  // namespace salbench
