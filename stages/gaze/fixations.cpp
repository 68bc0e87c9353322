// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/gaze/fixations.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "stages/core/errors.h"

namespace salbench {
namespace {

using Samples = std::span<const GazeSample>;

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

// Exact for small angles too, where the cosine is not.
double degrees_between(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) / kRadiansPerDegree;
}

// Samples that belong together, from the first to the last in time.
struct Group {
  double start = 0, end = 0;
  Vec3 origins = Vec3::Zero(), directions = Vec3::Zero();  // sums
  std::int32_t samples = 0;

  explicit Group(const GazeSample& first) : start(first.time) { add(first); }
  void add(const GazeSample& sample) {
    end = sample.time;
    origins += sample.origin;
    directions += sample.direction;
    ++samples;
  }
  void add(const Group& later) {
    end = later.end;
    origins += later.origins;
    directions += later.directions;
    samples += later.samples;
  }
  Fixation fixation() const {
    return {start, end - start, origins / samples, directions.normalized(), samples};
  }
};

// Runs of samples between which the eye is slow, a sample by itself among them.
std::vector<Group> slow_runs(Samples samples, double velocity) {
  std::vector<Group> runs;
  const GazeSample* previous = nullptr;
  for (const GazeSample& sample : samples) {
    const bool goes_on = sample.valid && previous != nullptr && previous->valid &&
                         degrees_between(previous->direction, sample.direction) <=
                             velocity * (sample.time - previous->time) / 1000;
    if (goes_on)
      runs.back().add(sample);
    else if (sample.valid)
      runs.emplace_back(sample);
    previous = &sample;
  }
  return runs;
}

// A run goes on an earlier one that ended shortly before and nearby, and both may go on one before them:
// noise breaks runs, and the more samples a group has the better it is known where it is. What is between two
// that are merged, as a sample that noise threw aside, is in neither.
std::vector<Group> merged(const std::vector<Group>& runs, const FixationOptions& options) {
  std::vector<Group> groups;
  for (Group grown : runs) {
    for (std::size_t k = groups.size(); k-- > 0 && grown.start - groups[k].end <= options.merge_ms;) {
      if (degrees_between(groups[k].directions, grown.directions) > options.merge_degrees) continue;
      groups[k].add(grown);
      grown = groups[k];
      groups.erase(groups.begin() + static_cast<std::ptrdiff_t>(k), groups.end());
    }
    groups.push_back(grown);
  }
  return groups;
}

// The window grows as long as no two of its samples are too far apart; one that is too short loses its first.
std::vector<Group> near_windows(Samples samples, const FixationOptions& options) {
  std::vector<const GazeSample*> valid;
  for (const GazeSample& sample : samples)
    if (sample.valid) valid.push_back(&sample);
  std::vector<Group> groups;
  for (std::size_t first = 0; first < valid.size();) {
    Group group(*valid[first]);
    std::size_t end = first + 1;
    const auto fits = [&](const GazeSample& sample) {
      return sample.time - valid[end - 1]->time <= options.merge_ms &&
             std::all_of(&valid[first], &valid[end - 1] + 1, [&](const GazeSample* other) {
               return degrees_between(other->direction, sample.direction) <= options.dispersion;
             });
    };
    for (; end < valid.size() && fits(*valid[end]); ++end) group.add(*valid[end]);
    const bool is_long = group.end - group.start >= options.min_ms;
    if (is_long) groups.push_back(group);
    first = is_long ? end : first + 1;
  }
  return groups;
}

std::vector<Fixation> each_sample(Samples samples, const FixationOptions& options) {
  std::vector<double> times;
  for (const GazeSample& sample : samples) times.push_back(sample.time);
  const std::vector<double> to_next = times_to_next(times, options.merge_ms);
  std::vector<Fixation> found;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!samples[i].valid) continue;
    found.push_back(Group(samples[i]).fixation());
    found.back().duration = to_next[i];
  }
  return found;
}

}  // namespace

std::vector<double> times_to_next(std::span<const double> times, double most) {
  std::vector<double> all;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const std::size_t from = i + 1 < times.size() ? i : std::max<std::size_t>(i, 1) - 1;
    all.push_back(times.size() > 1 ? std::min(times[from + 1] - times[from], most) : 0);
  }
  return all;
}

std::vector<Fixation> fixations(Samples samples, const FixationOptions& options) {
  check_samples(samples);
  if (!samples.empty())
    samples = Samples(
        std::ranges::lower_bound(samples, samples.front().time + options.skip_ms, {}, &GazeSample::time),
        samples.end());
  std::vector<Fixation> found;
  if (options.method == FixationMethod::none) {
    found = each_sample(samples, options);
  } else {
    const auto groups = options.method == FixationMethod::idt
                            ? near_windows(samples, options)
                            : merged(slow_runs(samples, options.velocity), options);
    for (const Group& group : groups)
      if (group.end - group.start >= options.min_ms) found.push_back(group.fixation());
  }
  if (options.skip_first && !found.empty()) found.erase(found.begin());
  return found;
}

}  // namespace salbench
