// Fast point feature histograms: the kernel that the descriptors' stage and some models share. [rusu2009]
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "stages/core/neighbours.h"
#include "stages/core/options.h"
#include "stages/core/types.h"

namespace salbench {

// Relation of two oriented points in the Darboux frame u, v, w of the source p.
struct DarbouxTriple {
  double alpha = 0;  // v . n_q, in [-1, 1]
  double phi = 0;    // u . (q - p) / |q - p|, in [-1, 1]
  double theta = 0;  // atan2(w . n_q, u . n_q), in [-pi, pi]
};

// All 0 if the points coincide or the frame is undefined (q straight above p). Normals have unit length. With
// `swap` the point whose normal makes the smaller angle with the line between them becomes the source, which
// makes the triple symmetric in p and q. [rusu2009]
DarbouxTriple pair_features(const Vec3& p, const Vec3& n_p, const Vec3& q, const Vec3& n_q, bool swap);

// The neighbours of a point: its `neighbours` nearest points or, if that is 0, all points within `radius`.
struct Support {
  std::int32_t neighbours = 0;  // the point itself included
  double radius = 0;            // in the shape's unit, the boundary included
};

// The neighbours of m queries in compressed rows. Those of query i, itself included, are the entries
// offsets[i] .. offsets[i + 1] - 1, ordered by (distance, index).
struct Neighbourhoods {
  std::vector<std::size_t> offsets;       // m + 1
  std::vector<std::int32_t> indices;      // point index
  std::vector<double> distances_squared;  // > 0 except for the point itself and those coincident with it

  std::size_t size() const { return offsets.size() - 1; }
  std::span<const std::int32_t> of(std::size_t i) const {
    return {indices.data() + offsets[i], indices.data() + offsets[i + 1]};
  }
  std::span<const double> distances_squared_of(std::size_t i) const {
    return {distances_squared.data() + offsets[i], distances_squared.data() + offsets[i + 1]};
  }
};

Neighbourhoods neighbourhoods(const KdTree& tree, std::span<const Vec3> queries, const Support& support);

enum class FpfhWeighting {
  published,  // sum of SPFH(q) / |p - q|^2 over the neighbours, each block of 11 bins scaled to 100
  text        // own SPFH + mean of SPFH(q) / |p - q|, distances in units of R, not scaled [tasse2016]
};
template <>
struct EnumNames<FpfhWeighting> {
  static constexpr std::array<std::string_view, 2> names{"published", "text"};
};

// The histograms (m x 33) of the points in `subset`, in its order, or of all points. `tree` is over `points`;
// normals n x 3, unit. A point without neighbours at a distance has an empty histogram, all 0. Throws
// InputError if a normal is not finite. [rusu2009] [tasse2016]
Descriptors fpfh(std::span<const Vec3> points, std::span<const Vec3> normals, const KdTree& tree,
                 const Support& support, FpfhWeighting weighting, std::span<const std::int32_t> subset);
Descriptors fpfh(std::span<const Vec3> points, std::span<const Vec3> normals, const KdTree& tree,
                 const Support& support, FpfhWeighting weighting);

}  // namespace salbench
