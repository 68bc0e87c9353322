// SPDX-License-Identifier: GPL-3.0-or-later
// From eye tracker samples to fixations, where one participant's eye rested on one shape.
//
//   ivt   velocity threshold: samples between which the eye turns by `velocity` at most
//   idt   dispersion threshold: samples of which no two are more than `dispersion` apart
//   none  each sample is a fixation that lasts to the next one
//
// Angles are measured between positions on the surface, both seen from the eye at the later sample: an eye
// that follows a position on a rotating shape, or that itself moves, rests. If a position is unknown, angles
// are between directions, which is equivalent for an eye and a shape at rest.
//
// [salvucci2000]
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "stages/core/options.h"
#include "stages/core/types.h"

namespace salbench {

struct GazeSample {
  double time = 0;  // ms
  Vec3 origin = Vec3::Zero(),
       direction = Vec3::UnitZ();  // in the frame of the shape; unit direction
  bool valid = true;               // false: the tracker lost the eye
  Vec3 place =
      Vec3::Constant(std::numeric_limits<double>::quiet_NaN());  // on the shape; NaN: missed or unknown

  bool has_place() const { return place.allFinite(); }
};

struct Fixation {
  double start = 0, duration = 0;                         // ms; from the first sample to the last
  Vec3 origin = Vec3::Zero(), direction = Vec3::UnitZ();  // mean eye, and mean position as seen from it
  std::int32_t samples = 0;
  Vec3 place = Vec3::Zero();  // mean position of its samples; NaN if unknown
};

enum class FixationMethod { ivt, idt, none };
template <>
struct EnumNames<FixationMethod> {
  static constexpr std::array<std::string_view, 3> names{"ivt", "idt", "none"};
};

struct FixationOptions {
  FixationMethod method = FixationMethod::ivt;
  double velocity = 30;
  double dispersion = 1;
  double min_ms = 100;
  double merge_ms = 75;
  double merge_degrees = 0.5;
  double skip_ms = 0;
  bool skip_first = false;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("method", self.method,
          {"how samples become fixations: by velocity, by dispersion, or each is one"});
    visit("velocity", self.velocity, {"ivt: slower samples belong to one fixation", "degrees/s", above(0)});
    visit("dispersion", self.dispersion,
          {"idt: largest angle between two samples of a fixation", "degrees", above_and_up_to(0, 180)});
    visit("min_ms", self.min_ms, {"fixations that are shorter are none", "ms", at_least(0)});
    visit("merge_ms", self.merge_ms,
          {"longest gap, as of a blink, that a fixation goes on over", "ms", at_least(0)});
    visit("merge_degrees", self.merge_degrees,
          {"ivt: largest angle between what is before such a gap and after it", "degrees", between(0, 180)});
    visit("skip_ms", self.skip_ms, {"left out at the beginning", "ms", at_least(0)});
    visit("skip_first", self.skip_first,
          {"leave out the first fixation, which began before the shape was shown"});
  }
};

// In order of time; invalid samples are ignored. Throws InputError for the first sample whose time does not
// increase, or that is valid with an eye position that is not finite or a direction that is not of unit
// length (to 1e-3): "sample 17: ...", counted from 1; and for wrong_with_times(), except with the method
// `none`.
std::vector<Fixation> fixations(std::span<const GazeSample> samples, const FixationOptions& options = {});

inline constexpr double kShortestStep = 0.3, kLongestStep = 200;  // ms between samples: 3.3 kHz to 5 Hz

// Intervals between a person's samples, whose times ascend.
class SampleSteps {
 public:
  explicit SampleSteps(std::span<const double> times);
  double median() const { return median_; }  // ms; 0 for fewer than two samples
  // True for a gap with missing samples, which ends a fixation as lost samples do.
  bool is_hole(double step) const;

 private:
  double median_ = 0;
};

// Reason why no eye tracker has such sampling times, with the unit that would fit; empty if one may.
std::string wrong_with_times(std::span<const double> times);

// Duration of each sample, in ms: to the next one; before a gap, the median interval; for the last, as for
// the one before it; at most `most`. A single sample lasts 0.
std::vector<double> sample_lengths(std::span<const double> times, double most);

}  // namespace salbench
