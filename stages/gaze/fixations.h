// SPDX-License-Identifier: GPL-3.0-or-later
// From samples of an eye tracker to fixations: where one participant's eye rested while it was on one shape.
//
//   ivt   velocity threshold: samples between which the direction turns by `velocity` at most
//   idt   dispersion threshold: samples of which no two directions are more than `dispersion` apart
//   none  each sample is a fixation that lasts to the next one
//
// [salvucci2000]
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "stages/core/options.h"
#include "stages/core/types.h"

namespace salbench {

struct GazeSample {
  double time = 0;  // ms
  Vec3 origin = Vec3::Zero(),
       direction = Vec3::UnitZ();  // in the frame of the shape; the direction is 1 long
  bool valid = true;               // false: the tracker lost the eye
};

struct Fixation {
  double start = 0, duration = 0;                         // ms; from the first sample to the last
  Vec3 origin = Vec3::Zero(), direction = Vec3::UnitZ();  // means of its samples
  std::int32_t samples = 0;
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

// In order of time. Samples that are not valid are in none. Throws InputError for the first sample whose time
// is no later than the one before, or which is valid and has a place that is not finite or a direction that
// is not of unit length (to 1e-3): "sample 17: ...", counted from 1.
std::vector<Fixation> fixations(std::span<const GazeSample> samples, const FixationOptions& options = {});

// From each of some ascending times to the next one, of the last as of the one before it; at most `most`. One
// time alone lasts 0.
std::vector<double> times_to_next(std::span<const double> times, double most);

}  // namespace salbench
