// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/gaze/fixations.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "stages/core/errors.h"
#include "stages/core/field.h"

namespace salbench {
namespace {

using Samples = std::span<const GazeSample>;

constexpr double kTimeRounding = 5e-4;  // ms, half of a microsecond, the finest step of timestamps

bool is_of_trackers(double step) { return kShortestStep <= step && step <= kLongestStep; }

void check_samples(Samples samples) {
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto refuse = [&](const std::string& wrong) {
      throw ShapeError(fmt::format("sample {}: {}", i + 1, wrong));
    };
    const GazeSample& sample = samples[i];
    if (!std::isfinite(sample.time)) refuse("its time is no finite number");
    if (i > 0 && !(sample.time > samples[i - 1].time))
      refuse(fmt::format("its time of {} ms is not after {} ms", sample.time, samples[i - 1].time));
    if (!sample.valid) continue;
    if (!sample.origin.allFinite()) refuse("its origin is not finite");
    if (const double length = sample.direction.norm(); !(std::abs(length - 1) <= 1e-3))
      refuse(fmt::format("its direction is {} long, and must be of unit length", length));
  }
}

// Accurate for small angles, unlike the arc cosine.
double degrees_between(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) / kRadiansPerDegree;
}

// Angle between two samples, as seen from the eye of the later one.
double degrees_turned(const GazeSample& earlier, const GazeSample& later) {
  const bool is_at_rest = earlier.origin == later.origin;
  if (is_at_rest || !earlier.has_place() || !later.has_place())
    return degrees_between(earlier.direction, later.direction);
  return degrees_between(earlier.place - later.origin, later.place - later.origin);
}

// Consecutive samples of one fixation.
class Group {
 public:
  explicit Group(const GazeSample& first) : start_(first.time), eye_(first.origin) { add(first); }

  double start() const { return start_; }
  double end() const { return end_; }
  double duration() const { return end_ - start_; }
  bool lasts(double ms) const { return duration() >= ms - kTimeRounding; }

  void add(const GazeSample& sample) {
    end_ = sample.time;
    is_at_rest_ = is_at_rest_ && sample.origin == eye_;
    origins_ += sample.origin;
    directions_ += sample.direction;
    ++samples_;
    if (!sample.has_place()) return;
    places_ += sample.place;
    ++placed_;
  }
  void add(const Group& later) {
    end_ = later.end_;
    is_at_rest_ = rests_with(later);
    origins_ += later.origins_;
    directions_ += later.directions_;
    samples_ += later.samples_;
    places_ += later.places_;
    placed_ += later.placed_;
  }

  double degrees_to(const Group& later) const {
    if (rests_with(later) || placed_ == 0 || later.placed_ == 0)
      return degrees_between(directions_, later.directions_);
    return degrees_between(places_ / placed_ - later.eye_, later.places_ / later.placed_ - later.eye_);
  }

  Fixation fixation() const {
    const Vec3 origin = origins_ / samples_, place = places_ / placed_;  // NaN if there are none
    const Vec3 towards = is_at_rest_ || placed_ == 0 ? directions_ : Vec3(place - origin);
    return {start_, duration(), origin, towards.normalized(), samples_, place};
  }

 private:
  bool rests_with(const Group& later) const { return is_at_rest_ && later.is_at_rest_ && eye_ == later.eye_; }

  double start_, end_ = 0;
  Vec3 eye_;  // from the first sample
  bool is_at_rest_ = true;
  Vec3 origins_ = Vec3::Zero(), directions_ = Vec3::Zero(), places_ = Vec3::Zero();  // sums
  std::int32_t samples_ = 0, placed_ = 0;                                            // with a place
};

// Runs of samples at low velocity, including single samples. A gap ends a run.
std::vector<Group> slow_runs(Samples samples, double velocity, const SampleSteps& steps) {
  std::vector<Group> runs;
  const GazeSample* previous = nullptr;
  for (const GazeSample& sample : samples) {
    const auto is_slow = [&](double ms) {
      return !steps.is_hole(ms) && degrees_turned(*previous, sample) <= velocity * ms / 1000;
    };
    const bool goes_on =
        sample.valid && previous != nullptr && previous->valid && is_slow(sample.time - previous->time);
    if (goes_on)
      runs.back().add(sample);
    else if (sample.valid)
      runs.emplace_back(sample);
    previous = &sample;
  }
  return runs;
}

// A run extends an earlier one that ended shortly before and nearby, and both may extend one before them:
// noise interrupts runs, and the position of a group becomes more certain with more samples. Samples between
// two merged runs, such as outliers, belong to neither.
std::vector<Group> merged(const std::vector<Group>& runs, const FixationOptions& options) {
  std::vector<Group> groups;
  for (Group grown : runs) {
    for (std::size_t k = groups.size(); k-- > 0 && grown.start() - groups[k].end() <= options.merge_ms;) {
      if (groups[k].degrees_to(grown) > options.merge_degrees) continue;
      groups[k].add(grown);
      grown = groups[k];
      groups.erase(groups.begin() + static_cast<std::ptrdiff_t>(k), groups.end());
    }
    groups.push_back(grown);
  }
  return groups;
}

// The window grows while all its samples are close together; a window that is too short drops its first.
std::vector<Group> near_windows(Samples samples, const FixationOptions& options, const SampleSteps& steps) {
  std::vector<const GazeSample*> valid;
  for (const GazeSample& sample : samples)
    if (sample.valid) valid.push_back(&sample);
  std::vector<Group> groups;
  for (std::size_t first = 0; first < valid.size();) {
    Group group(*valid[first]);
    std::size_t end = first + 1;
    const auto fits = [&](const GazeSample& sample) {
      const double step = sample.time - valid[end - 1]->time;
      return (step <= options.merge_ms || !steps.is_hole(step)) &&
             std::all_of(&valid[first], &valid[end - 1] + 1, [&](const GazeSample* other) {
               return degrees_turned(*other, sample) <= options.dispersion;
             });
    };
    for (; end < valid.size() && fits(*valid[end]); ++end) group.add(*valid[end]);
    const bool is_long = group.lasts(options.min_ms);
    if (is_long) groups.push_back(group);
    first = is_long ? end : first + 1;
  }
  return groups;
}

std::vector<double> times_of(Samples samples) {
  std::vector<double> times;
  for (const GazeSample& sample : samples) times.push_back(sample.time);
  return times;
}

std::vector<Fixation> each_sample(Samples samples, const FixationOptions& options) {
  const std::vector<double> lengths = sample_lengths(times_of(samples), options.merge_ms);
  std::vector<Fixation> found;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!samples[i].valid) continue;
    found.push_back(Group(samples[i]).fixation());
    found.back().duration = lengths[i];
  }
  return found;
}

std::vector<Fixation> of_groups(Samples samples, const FixationOptions& options) {
  const std::vector<double> times = times_of(samples);
  if (const std::string wrong = wrong_with_times(times); !wrong.empty()) throw ShapeError(wrong);
  const SampleSteps steps(times);
  const auto groups = options.method == FixationMethod::idt
                          ? near_windows(samples, options, steps)
                          : merged(slow_runs(samples, options.velocity, steps), options);
  std::vector<Fixation> found;
  for (const Group& group : groups)
    if (group.lasts(options.min_ms)) found.push_back(group.fixation());
  return found;
}

}  // namespace

SampleSteps::SampleSteps(std::span<const double> times) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < times.size(); ++i) steps.push_back(times[i] - times[i - 1]);
  if (!steps.empty()) median_ = upper_median(std::move(steps));
}

bool SampleSteps::is_hole(double step) const { return step > std::min(1.5 * median_, kLongestStep); }

std::string wrong_with_times(std::span<const double> times) {
  const double step = SampleSteps(times).median();
  if (!(step > 0) || is_of_trackers(step)) return {};  // backward steps are reported elsewhere
  std::string hint = "for rows that are no samples write gaze: {method: none}";
  struct Unit {
    const char* name;
    double ms;
  };
  for (const auto& [name, ms] : {Unit{"s", 1000}, Unit{"us", 1e-3}, Unit{"ns", 1e-6}})
    if (is_of_trackers(step * ms)) hint = fmt::format("the times are in ms, and would fit in {}", name);
  return fmt::format("samples are {:.6g} ms apart (median), and those of eye trackers {} to {} ms: {}", step,
                     kShortestStep, kLongestStep, hint);
}

std::vector<double> sample_lengths(std::span<const double> times, double most) {
  const SampleSteps steps(times);
  std::vector<double> lengths;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const std::size_t from = i + 1 < times.size() ? i : std::max<std::size_t>(i, 1) - 1;
    const double step = times.size() > 1 ? times[from + 1] - times[from] : 0;
    lengths.push_back(std::min(steps.is_hole(step) ? steps.median() : step, most));
  }
  return lengths;
}

std::vector<Fixation> fixations(Samples samples, const FixationOptions& options) {
  check_samples(samples);
  if (!samples.empty())
    samples = Samples(
        std::ranges::lower_bound(samples, samples.front().time + options.skip_ms, {}, &GazeSample::time),
        samples.end());
  std::vector<Fixation> found =
      options.method == FixationMethod::none ? each_sample(samples, options) : of_groups(samples, options);
  if (options.skip_first && !found.empty()) found.erase(found.begin());
  return found;
}

}  // namespace salbench
