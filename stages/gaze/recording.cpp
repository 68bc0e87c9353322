// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/gaze/recording.h"

#include <algorithm>
#include <limits>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "stages/core/errors.h"
#include "stages/geometry/mesh_ops.h"

namespace salbench {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// The rows of a person: from the first one to behind the last.
using Rows = std::pair<std::size_t, std::size_t>;

std::vector<Rows> rows_by_person(const std::vector<std::int32_t>& person, std::size_t people) {
  std::vector<Rows> rows;
  for (std::size_t p = 0; p < people; ++p) {
    const auto [first, last] = std::ranges::equal_range(person, static_cast<std::int32_t>(p));
    rows.emplace_back(first - person.begin(), last - person.begin());
  }
  return rows;
}

std::vector<GazeSample> samples_in(const GazeRecording& recording, const Rows& rows) {
  std::vector<GazeSample> samples;
  for (std::size_t i = rows.first; i < rows.second; ++i) {
    GazeSample& sample = samples.emplace_back();
    sample.time = recording.time[i];
    sample.valid = recording.valid[i] != 0;
    if (!recording.origins.empty()) sample.origin = recording.origins[i];
    if (recording.has_rays()) sample.direction = recording.directions[i];
  }
  return samples;
}

void append(GazeFixations& all, std::int32_t person, const std::vector<Fixation>& found) {
  for (const Fixation& one : found) {
    all.person.push_back(person);
    all.start.push_back(one.start);
    all.duration.push_back(one.duration);
    all.origins.push_back(one.origin);
    all.directions.push_back(one.direction);
  }
}

// Each valid row that is not left out at the beginning.
void append_rows(GazeFixations& all, const GazeRecording& recording, const Rows& rows,
                 const FixationOptions& options) {
  const auto [first, last] = rows;
  const std::span<const double> times(recording.time.data() + first, last - first);
  const std::vector<double> to_next =
      recording.durations.empty() ? times_to_next(times, options.merge_ms) : std::vector<double>();
  bool skip = options.skip_first;
  for (std::size_t i = first; i < last; ++i) {
    if (recording.valid[i] == 0 || recording.time[i] < times.front() + options.skip_ms) continue;
    if (std::exchange(skip, false)) continue;
    all.person.push_back(recording.person[i]);
    all.start.push_back(recording.time[i]);
    all.duration.push_back(to_next.empty() ? recording.durations[i] : to_next[i - first]);
    if (!recording.origins.empty()) all.origins.push_back(recording.origins[i]);
    if (recording.has_rays())
      all.directions.push_back(recording.directions[i]);
    else
      all.points.push_back(recording.points[i]);
  }
}

}  // namespace

GazeFixations fixations_of(const GazeRecording& recording, const FixationOptions& options) {
  GazeFixations all{.people = {.names = recording.people}};
  const auto rows = rows_by_person(recording.person, recording.people.size());
  for (std::size_t p = 0; p < rows.size(); ++p) {
    const auto [first, last] = rows[p];
    all.people.samples.push_back(static_cast<std::int64_t>(last - first));
    all.people.lost.push_back(std::count(recording.valid.begin() + static_cast<std::ptrdiff_t>(first),
                                         recording.valid.begin() + static_cast<std::ptrdiff_t>(last),
                                         std::uint8_t{0}));
    if (!recording.durations.empty() || !recording.has_rays()) {
      append_rows(all, recording, rows[p], options);
      continue;
    }
    try {
      append(all, static_cast<std::int32_t>(p), fixations(samples_in(recording, rows[p]), options));
    } catch (const ShapeError& error) {
      throw ShapeError(fmt::format("{}, {}", recording.people[p], error.what()));
    }
  }
  return all;
}

GazeHits hits_of(const Mesh& mesh, const GazeFixations& fixations, const GazeHitOptions& options) {
  GazeHits hits{.people = fixations.people,
                .person = fixations.person,
                .start = fixations.start,
                .duration = fixations.duration};
  const auto add = [&](const FirstHit& hit, double depth, bool snapped) {
    hits.face.push_back(hit ? static_cast<std::int32_t>(hit.face) : -1);
    hits.weights.push_back(hit.weights);
    hits.depth.push_back(hit ? depth : kUnknown);
    hits.snapped.push_back(snapped ? 1 : 0);
  };
  if (fixations.points.empty()) {
    std::vector<GazeRay> rays;
    for (std::size_t i = 0; i < fixations.directions.size(); ++i)
      rays.push_back({fixations.origins[i], fixations.directions[i]});
    for (const GazeHit& hit : gaze_hits(mesh, rays, options.rays)) add(hit, hit.depth, hit.snapped);
    return hits;
  }
  const TracedMesh traced(mesh);
  const double farthest = options.off * bounding_radius(mesh.vertices);
  for (std::size_t i = 0; i < fixations.points.size(); ++i) {
    const FirstHit hit = traced.nearest(fixations.points[i], farthest);
    const double depth =
        hit && !fixations.origins.empty() ? (hit.point_in(mesh) - fixations.origins[i]).norm() : kUnknown;
    add(hit, depth, false);
  }
  return hits;
}

std::vector<GazeCounts> counts_by_person(const GazeHits& hits) {
  std::vector<GazeCounts> counts(hits.people.names.size());
  for (std::size_t i = 0; i < hits.person.size(); ++i) {
    GazeCounts& own = counts[index(hits.person[i])];
    ++own.fixations;
    if (hits.face[i] < 0) continue;
    ++own.hits;
    own.snapped += hits.snapped[i];
    own.on_shape += hits.duration[i];
  }
  return counts;
}

std::string remark_on_people(const GazeHits& hits) {
  const std::vector<GazeCounts> counts = counts_by_person(hits);
  std::size_t missing = 0, brief = 0, first_missing = 0, first_brief = 0;
  for (std::size_t p = 0; p < counts.size(); ++p) {
    if (counts[p].fixations > 0 && counts[p].hits == 0 && missing++ == 0) first_missing = p;
    if (counts[p].hits > 0 && !(counts[p].on_shape > 0) && brief++ == 0) first_brief = p;
  }
  std::string remark;
  if (missing > 0)
    remark = fmt::format(
        "{} of {} people have no fixation on the shape (first: {}, 0 of {}): check the unit of length and "
        "the frame of the recording",
        missing, counts.size(), hits.people.names[first_missing], counts[first_missing].fixations);
  if (brief > 0)
    remark += fmt::format(
        "{}{} of {} people have only fixations of 0 ms on the shape (first: {}): write gaze: {{mass: one}} "
        "to count them",
        remark.empty() ? "" : "; ", brief, counts.size(), hits.people.names[first_brief]);
  return remark;
}

}  // namespace salbench
