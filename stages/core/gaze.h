// SPDX-License-Identifier: GPL-3.0-or-later
// Recordings of gaze, and what is made of them on the way to ground truth.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

// Who looked: the columns of what follows name people by their place here.
struct GazePeople {
  std::vector<std::string> names = {};
  std::vector<std::int64_t> samples = {}, lost = {};  // of each: recorded, and without an eye or a place
  // ms of each, without what is left out at the beginning: from the first sample to the end of the last, and
  // what the valid ones cover; NaN where rows are fixations already. Rows that are missing are in neither
  // count of samples, but in this difference.
  std::vector<double> recorded = {}, tracked = {};
};

// m samples, or fixations that others have found, person after person and each one's in order of time. They
// are rays of an eye, or hits: places on the surface. Columns that are not known are empty.
struct GazeRecording {
  std::vector<std::string> people = {};
  std::vector<std::int32_t> person = {};  // m
  std::vector<double> time = {};          // m, ms
  std::vector<std::uint8_t> valid = {};   // m; 0: the tracker lost the eye
  std::vector<Vec3> origins = {};         // m, the eye in the frame of the shape; of hits it may be unknown
  std::vector<Vec3> directions = {};      // m, of unit length; of rays alone
  std::vector<Vec3> points = {};          // m, in the frame of the shape; of hits alone
  std::vector<double> durations = {};     // m, ms, of fixations; of samples there are none

  bool empty() const { return person.empty(); }
  bool has_rays() const { return !directions.empty(); }
  bool has_eyes() const { return !origins.empty(); }
};

// k fixations. They are rays, or, of hits without an eye, points.
struct GazeFixations {
  GazePeople people = {};
  std::vector<std::int32_t> person = {};          // k
  std::vector<double> start = {}, duration = {};  // k, ms
  std::vector<Vec3> origins = {}, directions = {}, points = {};
};
// Where the k fixations are on a mesh.
struct GazeHits {
  GazePeople people = {};
  std::vector<std::int32_t> person = {};          // k
  std::vector<double> start = {}, duration = {};  // k, ms
  std::vector<std::int32_t> face = {};            // k; -1: missed
  std::vector<Vec3> weights = {};                 // k, barycentric, of the face's corners
  std::vector<double> depth = {};                 // k, distance from the eye; NaN where it is not known
  std::vector<std::uint8_t> snapped = {};         // k; 1: the nearest direction that meets the mesh was taken
  std::vector<Vec3> eyes = {};                    // k; empty where they are not known
};

// The share of each person's time of fixations, 0 to 1, in which a vertex could be seen from where the eye
// was.
struct VisibleShares {
  std::size_t n = 0;               // vertices
  std::vector<float> shares = {};  // people x n; 0 for people without a fixation
};

}  // namespace salbench
