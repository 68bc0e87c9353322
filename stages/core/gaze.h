// SPDX-License-Identifier: GPL-3.0-or-later
// Gaze recordings, and the intermediate results from them to ground truth.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

// Participants: the columns below refer to them by index.
struct GazePeople {
  std::vector<std::string> names = {};
  std::vector<std::int64_t> samples = {}, lost = {};  // per person: recorded samples, and those without eye
                                                      // or position
  // ms per person, after the skipped beginning: from the first sample to the end of the last, and the part
  // covered by valid samples; NaN if the rows are already fixations. Missing rows are in neither count of
  // samples, but in the difference of these times.
  std::vector<double> recorded = {}, tracked = {};
};

// m samples, or fixations detected by other software, ordered by person and time. Either rays of an eye, or
// hits: positions on the surface. Unknown columns are empty.
struct GazeRecording {
  std::vector<std::string> people = {};
  std::vector<std::int32_t> person = {};  // m
  std::vector<double> time = {};          // m, ms
  std::vector<std::uint8_t> valid = {};   // m; 0: the tracker lost the eye
  std::vector<Vec3> origins = {};         // m, eye in the frame of the shape; optional for hits
  std::vector<Vec3> directions = {};      // m, of unit length; only for rays
  std::vector<Vec3> points = {};          // m, in the frame of the shape; only for hits
  std::vector<double> durations = {};     // m, ms; only for fixations

  bool empty() const { return person.empty(); }
  bool has_rays() const { return !directions.empty(); }
  bool has_eyes() const { return !origins.empty(); }
};

// k fixations: rays, or points for hits without an eye.
struct GazeFixations {
  GazePeople people = {};
  std::vector<std::int32_t> person = {};          // k
  std::vector<double> start = {}, duration = {};  // k, ms
  std::vector<Vec3> origins = {}, directions = {}, points = {};
};
// Positions of the k fixations on a mesh.
struct GazeHits {
  GazePeople people = {};
  std::vector<std::int32_t> person = {};          // k
  std::vector<double> start = {}, duration = {};  // k, ms
  std::vector<std::int32_t> face = {};            // k; -1: missed
  std::vector<Vec3> weights = {};                 // k, barycentric, of the face's corners
  std::vector<double> depth = {};                 // k, distance from the eye; NaN if unknown
  std::vector<std::uint8_t> snapped = {};         // k; 1: moved to the nearest direction that meets the mesh
  std::vector<Vec3> eyes = {};                    // k; empty if unknown
};

// Share of each person's fixation time, 0 to 1, in which a vertex was visible from the position of the eye.
struct VisibleShares {
  std::size_t n = 0;               // vertices
  std::vector<float> shares = {};  // people x n; 0 for people without a fixation
};

}  // namespace salbench
