// SPDX-License-Identifier: GPL-3.0-or-later
// The work of our stages, done by the libraries that Debian has. A library is given the shape in its
// own structures, while our stages start from a Shape: converting it is not measured. Both sides build their
// search trees and hierarchies anew each time.
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

// FPFH of the mesh's vertices. PCL works in float, and takes no absolute values of the features.
Work pcl_fpfh(const Shape& shape, const Support& support);

// Normals of the scan's planes, turned towards the camera. PCL works in float, does not decide between
// equally distant neighbours, and does not look for neighbourhoods on a line.
Work pcl_normals(const Shape& shape, std::int32_t neighbours);

// Normals of the scan's planes, oriented by Hoppe's tree. CGAL passes the orientation across depth jumps and
// folds, has one seed in all, and leaves some points without orientation, which do not count.
Work cgal_normals(const Shape& shape, const ScanNormalsOptions& options);

// Greedy projection triangulation of the scan. The spacing that its limits are in is computed before, and
// faces that overlap or are turned over stay.
Work pcl_surface(const Shape& shape, const SurfaceOptions& options);

// Nearest hits of the rays of the first `views` scans on one hierarchy. The rays are made before. Which hit
// is nearest, and where it is, is decided by Embree in float, with the widest instructions of the machine, so
// that machines differ.
Work embree_scans(const Shape& shape, int views);

// Quadric collapses of the mesh to so many faces. CGAL takes manifold meshes only: throws std::runtime_error
// for others.
Work cgal_simplified(const Shape& shape, std::size_t faces);
// The same, in float and with vertices of the mesh alone: an edge collapses into one of its ends.
Work meshoptimizer_simplified(const Shape& shape, std::size_t faces);

// Chi-square distances of kQueries descriptors of the mesh, evenly chosen, from all. FLANN's is a plain loop
// over the 33 bins of a pair.
inline constexpr std::size_t kQueries = 256;
Work flann_chi_squares(const Shape& shape);

}  // namespace salbench::peers
