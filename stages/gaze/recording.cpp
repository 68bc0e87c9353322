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

// Rows of a person: first, and one past the last.
using Rows = std::pair<std::size_t, std::size_t>;

std::vector<Rows> rows_by_person(const std::vector<std::int32_t>& person, std::size_t people) {
  std::vector<Rows> rows;
  for (std::size_t p = 0; p < people; ++p) {
    const auto [first, last] = std::ranges::equal_range(person, static_cast<std::int32_t>(p));
    rows.emplace_back(first - person.begin(), last - person.begin());
  }
  return rows;
}

// Gaze positions by row; NaN if a ray misses the mesh or the tracker lost the eye.
std::vector<Vec3> places_in(const GazeRecording& recording, const Mesh& mesh) {
  if (!recording.has_rays()) return recording.points;
  std::vector<Vec3> places(recording.person.size(), Vec3::Constant(kUnknown));
  std::vector<GazeRay> rays;
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (recording.valid[i] == 0) continue;
    rays.push_back({recording.origins[i], recording.directions[i]});
    rows.push_back(i);
  }
  const std::vector<GazeHit> hits = gaze_hits(mesh, rays);
  for (std::size_t k = 0; k < hits.size(); ++k)
    if (hits[k]) places[rows[k]] = hits[k].point_in(mesh);
  return places;
}

std::vector<GazeSample> samples_in(const GazeRecording& recording, const std::vector<Vec3>& places,
                                   const Rows& rows) {
  std::vector<GazeSample> samples;
  for (std::size_t i = rows.first; i < rows.second; ++i) {
    GazeSample& sample = samples.emplace_back();
    sample.time = recording.time[i];
    sample.valid = recording.valid[i] != 0;
    sample.origin = recording.origins[i];
    if (!places.empty()) sample.place = places[i];
    sample.direction =
        recording.has_rays() ? recording.directions[i] : Vec3((sample.place - sample.origin).normalized());
  }
  return samples;
}

void append(GazeFixations& all, std::int32_t person, const std::vector<Fixation>& found, bool are_rays) {
  for (const Fixation& one : found) {
    all.person.push_back(person);
    all.start.push_back(one.start);
    all.duration.push_back(one.duration);
    all.origins.push_back(one.origin);
    if (are_rays)
      all.directions.push_back(one.direction);
    else
      all.points.push_back(one.place);
  }
}

// Appends each valid row after the skipped beginning.
void append_rows(GazeFixations& all, const GazeRecording& recording, const Rows& rows,
                 const std::vector<double>& lengths, const FixationOptions& options) {
  const auto [first, last] = rows;
  bool skip = options.skip_first;
  for (std::size_t i = first; i < last; ++i) {
    if (recording.valid[i] == 0 || recording.time[i] < recording.time[first] + options.skip_ms) continue;
    if (std::exchange(skip, false)) continue;
    all.person.push_back(recording.person[i]);
    all.start.push_back(recording.time[i]);
    all.duration.push_back(lengths[i - first]);
    if (recording.has_eyes()) all.origins.push_back(recording.origins[i]);
    if (recording.has_rays())
      all.directions.push_back(recording.directions[i]);
    else
      all.points.push_back(recording.points[i]);
  }
}

bool are_fixations(const GazeRecording& recording) { return !recording.durations.empty(); }

std::span<const double> rows_of(const std::vector<double>& column, const Rows& rows) {
  return std::span(column).subspan(rows.first, rows.second - rows.first);
}

// Duration of each row in ms; `most`: upper limit for a sample.
std::vector<double> lengths_in(const GazeRecording& recording, const Rows& rows, double most) {
  if (!are_fixations(recording)) return sample_lengths(rows_of(recording.time, rows), most);
  const auto durations = rows_of(recording.durations, rows);
  return {durations.begin(), durations.end()};
}

// Appends sample and time counts of a person. The tracked time is unknown for fixations from other software.
void append_person(GazePeople& people, const GazeRecording& recording, const Rows& rows, double skip_ms) {
  const auto times = rows_of(recording.time, rows);
  const std::vector<double> lengths = sample_lengths(times, std::numeric_limits<double>::infinity());
  std::int64_t lost = 0;
  double begin = kUnknown, tracked = kUnknown;
  for (std::size_t k = 0; k < times.size(); ++k) {
    const bool valid = recording.valid[rows.first + k] != 0;
    lost += valid ? 0 : 1;
    if (are_fixations(recording) || times[k] < times.front() + skip_ms) continue;
    if (std::isnan(begin)) {
      begin = times[k];
      tracked = 0;
    }
    tracked += valid ? lengths[k] : 0;
  }
  people.samples.push_back(std::ssize(times));
  people.lost.push_back(lost);
  people.recorded.push_back(times.empty() ? kUnknown : times.back() + lengths.back() - begin);
  people.tracked.push_back(tracked);
}

}  // namespace

GazeFixations fixations_of(const GazeRecording& recording, const Mesh& mesh, const FixationOptions& options) {
  GazeFixations all{.people = {.names = recording.people}};
  // angles need an eye
  const bool by_row = are_fixations(recording) || !recording.has_eyes();
  const bool by_angle = !by_row && options.method != FixationMethod::none;
  const std::vector<Vec3> places =
      by_angle || !recording.has_rays() ? places_in(recording, mesh) : std::vector<Vec3>();
  std::string wrong;
  std::size_t wrong_people = 0;
  const auto rows = rows_by_person(recording.person, recording.people.size());
  for (std::size_t p = 0; p < rows.size(); ++p) {
    append_person(all.people, recording, rows[p], options.skip_ms);
    if (by_row) {
      append_rows(all, recording, rows[p], lengths_in(recording, rows[p], options.merge_ms), options);
      continue;
    }
    const std::string found = by_angle ? wrong_with_times(rows_of(recording.time, rows[p])) : "";
    if (!found.empty()) {
      if (wrong_people++ == 0) wrong = fmt::format("{}: {}", recording.people[p], found);
      continue;
    }
    try {
      append(all, static_cast<std::int32_t>(p), fixations(samples_in(recording, places, rows[p]), options),
             recording.has_rays());
    } catch (const ShapeError& error) {
      throw ShapeError(fmt::format("{}, {}", recording.people[p], error.what()));
    }
  }
  if (wrong_people > 0 && wrong_people == rows.size()) throw ShapeError(wrong);
  return all;
}

GazeHits hits_of(const Mesh& mesh, const GazeFixations& fixations, const GazeHitOptions& options) {
  GazeHits hits{.people = fixations.people,
                .person = fixations.person,
                .start = fixations.start,
                .duration = fixations.duration,
                .eyes = fixations.origins};
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
    own.fixated += hits.duration[i];
    if (hits.face[i] < 0) continue;
    ++own.hits;
    own.snapped += hits.snapped[i];
    own.on_shape += hits.duration[i];
  }
  return counts;
}

std::vector<std::string> left_out_people(const GazePeople& people, const GazePeopleOptions& options) {
  std::vector<std::string> reasons;
  for (std::size_t p = 0; p < people.names.size(); ++p) {
    const double recorded = people.recorded[p], tracked = people.tracked[p];
    const double lost = recorded > 0 ? std::max(0.0, 1 - tracked / recorded) : 0;
    std::string& reason = reasons.emplace_back();
    if (lost > options.most_lost)
      reason = fmt::format("lost {:.0f} %", 100 * lost);
    else if (recorded > 0 && tracked < 1000 * options.least_seconds)
      reason = fmt::format("tracked for {:.2g} s", tracked / 1000);
  }
  return reasons;
}

namespace {

constexpr std::size_t kMostNamed = 5;  // per line

// "2 of 10 people ...: P3 (lost 83 %), P7 (...)" for those with a reason; empty if there are none.
std::string of_people(const std::vector<std::string>& names, const std::vector<std::string>& reasons,
                      std::string_view what) {
  std::string list;
  std::size_t n = 0;
  for (std::size_t p = 0; p < names.size(); ++p)
    if (!reasons[p].empty() && n++ < kMostNamed)
      list += fmt::format("{}{} ({})", list.empty() ? "" : ", ", names[p], reasons[p]);
  if (n > kMostNamed) list += fmt::format(" and {} more", n - kMostNamed);
  return n == 0 ? "" : fmt::format("{} of {} people {}: {}", n, names.size(), what, list);
}

// Per person: hits on the back of a face, from an eye in the bounding box of the mesh.
std::vector<std::int64_t> hits_from_inside(const GazeHits& hits, const Mesh& mesh) {
  std::vector<std::int64_t> inside(hits.people.names.size());
  Eigen::AlignedBox3d box;
  for (const Vec3& point : mesh.vertices) box.extend(point);
  for (std::size_t i = 0; i < hits.eyes.size(); ++i) {
    if (hits.face[i] < 0 || !box.contains(hits.eyes[i])) continue;
    const Triangle& face = mesh.faces[index(hits.face[i])];
    if (face_area_vector(mesh, face).dot(mesh.vertices[index(face[0])] - hits.eyes[i]) > 0)
      ++inside[index(hits.person[i])];
  }
  return inside;
}

}  // namespace

std::string remark_on_left_out(const GazePeople& people, const GazePeopleOptions& options) {
  return of_people(people.names, left_out_people(people, options), "are left out");
}

std::string remark_on_people(const GazeHits& hits, const Mesh& mesh) {
  const std::vector<GazeCounts> counts = counts_by_person(hits);
  const std::vector<std::int64_t> from_inside = hits_from_inside(hits, mesh);
  const std::vector<std::string>& names = hits.people.names;
  std::vector<std::string> missing(names.size()), inside(names.size()), brief(names.size()),
      broken(names.size());
  for (std::size_t p = 0; p < counts.size(); ++p) {
    const GazeCounts& own = counts[p];
    const double tracked = hits.people.tracked[p];
    if (own.fixations > 0 && own.hits == 0) missing[p] = fmt::format("0 of {}", own.fixations);
    if (2 * from_inside[p] > own.hits) inside[p] = fmt::format("{} of {}", from_inside[p], own.hits);
    if (own.hits > 0 && !(own.on_shape > 0)) brief[p] = "0 ms";
    if (own.fixated < tracked / 2) broken[p] = fmt::format("{:.0f} %", 100 * own.fixated / tracked);
  }
  std::string remark;
  const auto add = [&](const std::vector<std::string>& reasons, std::string_view what,
                       std::string_view then) {
    if (const std::string text = of_people(names, reasons, what); !text.empty())
      remark += fmt::format("{}{}: {}", remark.empty() ? "" : "; ", text, then);
  };
  add(missing, "have no fixation on the shape", "check the unit of length and the frame of the recording");
  add(inside, "look from inside the shape at the back of its faces", "check the unit of length");
  add(brief, "have only fixations of 0 ms on the shape", "write gaze: {mass: one} to count them");
  add(broken, "have fixations in less than half of the time that they were tracked",
      "check the noise of the recording, gaze: {velocity}, and the frame of a shape that turns");
  return remark;
}

}  // namespace salbench
