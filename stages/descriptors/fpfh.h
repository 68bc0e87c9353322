// SPDX-License-Identifier: GPL-3.0-or-later
// Fast point feature histograms: the descriptors of a shape, and their kernel, which some models call too.
// [rusu2009]
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "stages/core/options.h"
#include "stages/core/types.h"
#include "stages/geometry/neighbours.h"
#include "stages/geometry/support.h"

namespace salbench {

// Neighbours of a point: its `neighbours` nearest points or, if that is 0, all points within `radius`.
struct Support {
  std::int32_t neighbours = 0;  // includes the point itself
  double radius = 0;            // in the shape's unit; includes the boundary
};

enum class FpfhWeighting {
  published,  // sum of SPFH(q) / |p - q|^2 over the neighbours, each block of 11 bins scaled to 100
  text        // own SPFH + mean of SPFH(q) / |p - q|, distances in units of R, not scaled [tasse2016]
};
template <>
struct EnumNames<FpfhWeighting> {
  static constexpr std::array<std::string_view, 2> names{"published", "text"};
};

// Histograms (m x 33) of the points in `subset`, in its order, or of all points. `tree` is over `points`, or
// over some of them; neighbours are then these and the point itself. normals n x 3, unit. A point without
// neighbours at a distance has an empty histogram, all 0. Memory O(n) for any radius. Throws InputError if a
// normal is not finite. [rusu2009] [tasse2016]
Descriptors fpfh(std::span<const Vec3> points, std::span<const Vec3> normals, const KdTree& tree,
                 const Support& support, FpfhWeighting weighting, std::span<const std::int32_t> subset);
Descriptors fpfh(std::span<const Vec3> points, std::span<const Vec3> normals, const KdTree& tree,
                 const Support& support, FpfhWeighting weighting);

enum class FpfhNeighbourhood { nearest, radius };
template <>
struct EnumNames<FpfhNeighbourhood> {
  static constexpr std::array<std::string_view, 2> names{"nearest", "radius"};
};

struct FpfhOptions {
  FpfhNeighbourhood neighbourhood = FpfhNeighbourhood::nearest;
  std::int32_t neighbours = 9;
  double radius = 0.01;
  bool grow = true;
  std::int32_t grown_neighbours = kMinMeanNeighbours;
  FpfhWeighting weighting = FpfhWeighting::published;

  static FpfhOptions text() {  // as in the paper's text
    return {.neighbourhood = FpfhNeighbourhood::radius, .weighting = FpfhWeighting::text};
  }

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("neighbourhood", self.neighbourhood, {"take so many nearest points, or all within a radius"});
    visit("neighbours", self.neighbours,
          {"nearest points, the point itself included", "points", at_least(2)});
    visit("radius", self.radius, {"support radius", "R", above(0)});
    visit("grow", self.grow, {"enlarge the radius until it holds enough other points on average"});
    visit("grown_neighbours", self.grown_neighbours,
          {"that many are enough; the mean is rounded down", "points", between(1, 1000), "6"});
    visit("weighting", self.weighting, {"how the neighbours' histograms are combined"});
  }
};

// Descriptors of scans. The published scores and distributions of scans fit a radius, not the nearest points.
struct ScanFpfhOptions : FpfhOptions {
  ScanFpfhOptions() : FpfhOptions{.neighbourhood = FpfhNeighbourhood::radius, .grown_neighbours = 12} {}
  explicit ScanFpfhOptions(const FpfhOptions& options) : FpfhOptions(options) {}

  static ScanFpfhOptions text() { return ScanFpfhOptions(FpfhOptions::text()); }
};

// n x 33; points and normals n x 3, normals of unit length. The support used is stored with the histograms.
// Throws InputError for a shape without points or with a coordinate that is not finite, and like
// require_few_neighbours for a radius. [rusu2009] [tasse2016]
Descriptors fpfh(std::span<const Vec3> points, std::span<const Vec3> normals, const FpfhOptions& options);

}  // namespace salbench
