// SPDX-License-Identifier: GPL-3.0-or-later
// Point clouds from files: real scans and points of any origin. Validation before any computation.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

struct PointCloud {
  std::vector<Vec3> points;            // n x 3, in the order of the file; unit of the file
  Normals normals = {};                // n x 3, unit length; empty: not in the file
  std::optional<Vec3> viewpoint = {};  // position of the sensor; nullopt if unknown
  // Ascending 0-based numbers in the file of the dropped points, where nothing was measured.
  std::vector<std::int32_t> dropped = {};

  std::size_t size_in_file() const { return points.size() + dropped.size(); }
};

inline constexpr std::size_t kFewestPoints = 9;  // neighbourhood of PS and LS, including the point itself

struct CheckedCloud {
  PointCloud cloud;
  std::vector<std::string> warnings;  // one line each
};

// Drops points with a coordinate that is not finite, which depth cameras write where they measure nothing.
// Normalises the normals; those within rounding error of unit length are unchanged. Normals that are all zero
// count as absent. Throws InputError if fewer than kFewestPoints remain, if all are in one place, if only
// some have a normal, and for coordinates that are too large, including those of the viewpoint.
CheckedCloud check_cloud(PointCloud cloud);

// For each point of the file, its number among the remaining points; -1 if dropped.
std::vector<std::int32_t> numbers_left(const PointCloud& cloud);

// Values of the remaining points, from one value per point of the file.
ScalarField values_left(const PointCloud& cloud, const ScalarField& in_file);

// Translates picks from numbers in the file to numbers of the remaining points. Throws InputError for a pick
// of a dropped point.
std::vector<std::vector<std::int32_t>> picks_left(const PointCloud& cloud,
                                                  std::vector<std::vector<std::int32_t>> in_file);

}  // namespace salbench
