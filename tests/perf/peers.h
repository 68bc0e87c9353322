// SPDX-License-Identifier: GPL-3.0-or-later
// What stages do, done by the libraries of the field as Debian has them. A peer is given everything in its
// own structures, so that copying a shape into these is left out, while our stages start from a Shape; each
// search tree and hierarchy is built anew each time, on both sides.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "stages/core/fpfh.h"
#include "stages/normals/normals.h"
#include "stages/surface/surface.h"
#include "tests/perf/shapes.h"

namespace salbench::peers {

// Does the work once, and returns how many points, faces or pairs came out. What it reads is prepared before,
// or is the shape's, which outlives it.
using Work = std::function<std::size_t()>;

// Of the mesh. Leaves out double precision and absolute values of the features.
Work pcl_fpfh(const Shape& shape, const Support& support);

// Of the scan: planes turned towards the camera. Leaves out that of equally distant neighbours the index
// decides, neighbourhoods on a line, and double precision.
Work pcl_normals(const Shape& shape, std::int32_t neighbours);

// Of the scan: planes oriented by Hoppe's tree as a whole. Leaves out depth jumps and folds, which it
// crosses, and a seed per component.
Work cgal_normals(const Shape& shape, const ScanNormalsOptions& options);

// Of the scan: bare greedy projection. Leaves out the median spacing that the limits are in, and faces that
// overlap or are turned over.
Work pcl_surface(const Shape& shape, const SurfaceOptions& options);

// Nearest hits of the rays of the first `views` scans, on one hierarchy. Leaves out making the rays, the
// choice of the nearest hit and its place in double precision, and equal hits on all machines: the hit is the
// one that Embree finds nearest with the widest instructions of this one.
Work embree_scans(const Shape& shape, int views);

// Quadric collapses of the mesh to so many faces. Throws std::runtime_error for a mesh that is not manifold,
// which ours takes.
Work cgal_simplified(const Shape& shape, std::size_t faces);
// Leaves out places between the vertices: an edge collapses into one of its ends.
Work meshoptimizer_simplified(const Shape& shape, std::size_t faces);

// Chi-square distances of kQueries descriptors of the mesh, evenly chosen, from all: a plain loop over the 33
// bins of each pair.
inline constexpr std::size_t kQueries = 256;
Work flann_chi_squares(const Shape& shape);

}  // namespace salbench::peers
