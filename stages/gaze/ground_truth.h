// SPDX-License-Identifier: GPL-3.0-or-later
// Human ground truth of a mesh from gaze.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "stages/gaze/density.h"
#include "stages/gaze/recording.h"

namespace salbench {

enum class GazeMass { duration, one };
template <>
struct EnumNames<GazeMass> {
  static constexpr std::array<std::string_view, 2> names{"duration", "one"};
};

enum class GazeWeight { people, mass };
template <>
struct EnumNames<GazeWeight> {
  static constexpr std::array<std::string_view, 2> names{"people", "mass"};
};

enum class GazePicks { none, fixations };
template <>
struct EnumNames<GazePicks> {
  static constexpr std::array<std::string_view, 2> names{"none", "fixations"};
};

enum class GazeVisible { ignored, divided };
template <>
struct EnumNames<GazeVisible> {
  static constexpr std::array<std::string_view, 2> names{"ignored", "divided"};
};

struct GazeTruthOptions {
  GazePeopleOptions people = {};
  GazeDensityOptions density = {};
  GazeMass mass = GazeMass::duration;
  GazeWeight weight = GazeWeight::people;
  GazePicks picks = GazePicks::none;
  GazeVisible visible = GazeVisible::ignored;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    GazePeopleOptions::fields(self.people, visit);
    GazeDensityOptions::fields(self.density, visit);
    visit("mass", self.mass, {"what a fixation weighs: as long as it lasts, or all the same"});
    visit("weight", self.weight,
          {"all people count the same, or as the mass of their fixations on the shape"});
    visit(
        "picks", self.picks,
        {"for metrics that read picks: none, or of each face that is looked at the corner that is nearest"});
    visit("visible", self.visible,
          {"divided: by the share of the time in which a vertex could be seen from the eye"});
  }
};

// Eye positions closer to each other than a hundredth of their distance to the shape's centroid are merged.
// Throws InputError if the position of an eye is unknown.
VisibleShares visible_shares(const Mesh& mesh, const GazeFixations& fixations);

// Saliency: mean gaze density per unit of area over the included people. Viewers: maps of those who looked at
// the shape, in their order; NaN for vertices without a face, and for vertices that were never visible if the
// options take that into account. With weights by mass, saliency is divided by the mass of those who could
// see a vertex, times the share of time in which they could, and viewers are not weighted. `visible`: null
// unless the options divide by it. Throws InputError if no included person looked at the shape, or if
// durations are used as masses and all are 0.
GroundTruth gaze_ground_truth(const Mesh& mesh, const GazeHits& hits, const VisibleShares* visible,
                              const GazeTruthOptions& options);

// The same per face (f instead of n): means of the faces' corners, without viewers and picks.
GroundTruth gaze_face_truth(const Mesh& mesh, const GazeHits& hits, const VisibleShares* visible,
                            const GazeTruthOptions& options);

}  // namespace salbench
