// SPDX-License-Identifier: GPL-3.0-or-later
// Point clouds from files: real scans, and points from anywhere. Validation before anything is computed from
// one.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

struct PointCloud {
  std::vector<Vec3> points;            // n x 3, in the order of the file; unit of the file
  Normals normals = {};                // n x 3, unit length; empty: the file has none
  std::optional<Vec3> viewpoint = {};  // where the points were seen from; nothing if unknown
  // Ascending: 0-based numbers that the points left out have in the file, as nothing was seen there.
  std::vector<std::int32_t> dropped = {};

  std::size_t size_in_file() const { return points.size() + dropped.size(); }
};

inline constexpr std::size_t kFewestPoints = 9;  // by which PS and LS describe a point, itself included

struct CheckedCloud {
  PointCloud cloud;
  std::vector<std::string> warnings;  // one line each
};

// Drops the points with a coordinate that is not finite: depth cameras write so where they see nothing.
// Makes the normals unit length; those that are within rounding are left as they are. Normals that are zero
// at every point count as not given. Throws InputError if fewer than kFewestPoints are left, if all are in
// one place, if only some have a normal, and for coordinates that are too large, the viewpoint's too.
CheckedCloud check_cloud(PointCloud cloud);

// For each point of the file its number among the points that are left; -1 if it was left out.
std::vector<std::int32_t> numbers_left(const PointCloud& cloud);

// Values of the points that are left, from one value per point of the file.
ScalarField values_left(const PointCloud& cloud, const ScalarField& in_file);

// Picks by the numbers of the points that are left, from picks by those of the file. Throws InputError for a
// pick of a point that was left out.
std::vector<std::vector<std::int32_t>> picks_left(const PointCloud& cloud,
                                                  std::vector<std::vector<std::int32_t>> in_file);

}  // namespace salbench
