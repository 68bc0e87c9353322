// SPDX-License-Identifier: GPL-3.0-or-later
// Fast point feature histograms: the kernel that the descriptors' stage and some models share. [rusu2009]
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "stages/core/neighbours.h"
#include "stages/core/options.h"
#include "stages/core/types.h"

namespace salbench {

// The neighbours of a point: its `neighbours` nearest points or, if that is 0, all points within `radius`.
struct Support {
  std::int32_t neighbours = 0;  // the point itself included
  double radius = 0;            // in the shape's unit, the boundary included
};

enum class FpfhWeighting {
  published,  // sum of SPFH(q) / |p - q|^2 over the neighbours, each block of 11 bins scaled to 100
  text        // own SPFH + mean of SPFH(q) / |p - q|, distances in units of R, not scaled [tasse2016]
};
template <>
struct EnumNames<FpfhWeighting> {
  static constexpr std::array<std::string_view, 2> names{"published", "text"};
};

// The histograms (m x 33) of the points in `subset`, in its order, or of all points. `tree` is over `points`,
// or over some of them: neighbours are then these and the point itself. normals n x 3, unit. A point without
// neighbours at a distance has an empty histogram, all 0. Memory O(n) whatever the radius. Throws InputError
// if a normal is not finite. [rusu2009] [tasse2016]
Descriptors fpfh(std::span<const Vec3> points, std::span<const Vec3> normals, const KdTree& tree,
                 const Support& support, FpfhWeighting weighting, std::span<const std::int32_t> subset);
Descriptors fpfh(std::span<const Vec3> points, std::span<const Vec3> normals, const KdTree& tree,
                 const Support& support, FpfhWeighting weighting);

}  // namespace salbench
