// SPDX-License-Identifier: GPL-3.0-or-later
// First half of CS: divides a point set into small compact clusters of similar descriptors.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "stages/core/types.h"
#include "stages/models/cs.h"

namespace salbench {

// Means over groups of points; 0 for a group without points.
struct GroupMeans {
  std::vector<Vec3> centres;        // m x 3
  Descriptors descriptors;          // m x 33
  std::vector<std::int32_t> sizes;  // m: number of points in the group

  std::size_t size() const { return sizes.size(); }
};

// Point i, with descriptor i, belongs to group group_of[i] in 0..count-1.
GroupMeans group_means(std::span<const Vec3> points, const Descriptors& descriptors,
                       std::span<const std::int32_t> group_of, std::size_t count);

struct Clusters {
  std::vector<std::int32_t> of_point;  // n: 0..count-1
  std::size_t count = 0;               // no cluster is empty
};

// points n x 3, descriptors n x 33, n > 0; `radius` > 0 is the grown support radius and `unit` > 0 the
// shape's R. The number of clusters is about options.clusters, from half to one and a half times as many.
// [tasse2015]
Clusters cs_clusters(std::span<const Vec3> points, const Descriptors& descriptors, double radius, double unit,
                     const CsOptions& options);

}  // namespace salbench
