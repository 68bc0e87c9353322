// SPDX-License-Identifier: GPL-3.0-or-later
// Human ground truth of a mesh from where people looked.
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

// Places of an eye no farther from each other than a hundredth of their distance to the shape's centroid are
// one. Throws InputError where the eye's place is not known.
VisibleShares visible_shares(const Mesh& mesh, const GazeFixations& fixations);

// Saliency: the mean over people who count of how densely each looked, per unit of area. Viewers: those of
// them who looked at the shape, in their order; NaN where a vertex has no face, and where it could never be
// seen, if that is taken into account. `visible`: null unless the options divide by it. Throws InputError if
// nobody who counts looked at the shape, or for no time if that is their mass.
GroundTruth gaze_ground_truth(const Mesh& mesh, const GazeHits& hits, const VisibleShares* visible,
                              const GazeTruthOptions& options);

// The same by face, f in place of n: the means of the faces' corners. Neither viewers nor picks.
GroundTruth gaze_face_truth(const Mesh& mesh, const GazeHits& hits, const VisibleShares* visible,
                            const GazeTruthOptions& options);

}  // namespace salbench
