// The plain structs that flow between the stages. A "shape" is a mesh or one scan of it: n points, each
// with a normal, and faces where there are any. Coordinates are in the mesh's own, arbitrary length unit.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace salbench {

using Vec3 = Eigen::Vector3d;                  // 24 bytes, never over-aligned
using Triangle = std::array<std::int32_t, 3>;  // 0-based point indices, counter-clockwise seen from outside
using ScalarField = std::vector<double>;       // n, one value per point of a shape

struct Mesh {
  std::vector<Vec3> vertices;   // n x 3
  std::vector<Triangle> faces;  // f x 3
};

// One simulated range image as a point set; in the coordinates of its mesh (x_in_mesh).
struct Scan {
  std::vector<Vec3> points;    // n x 3, row by row of the ray grid
  Vec3 camera = Vec3::Zero();  // centre of projection
};

using Normals = std::vector<Vec3>;    // n x 3, unit length, outward or towards the camera
using Faces = std::vector<Triangle>;  // f x 3, of a surface over the points of a scan

inline constexpr int kFpfhBins = 33;  // three features of 11 bins: theta, alpha, phi

// Fast point feature histograms of n points. [rusu2009]
struct Descriptors {
  std::vector<float> values;  // n x 33, row major
  double radius = 0;          // support radius in the shape's unit; 0 where neighbours were counted instead
  std::int32_t neighbours =
      0;  // number of nearest points including the point itself; 0 where a radius was used

  std::size_t size() const { return values.size() / kFpfhBins; }
  std::span<const float, kFpfhBins> row(std::size_t i) const {
    return std::span<const float, kFpfhBins>(values.data() + i * kFpfhBins, kFpfhBins);
  }
};

// What people marked on a shape. [chen2012]
struct GroundTruth {
  ScalarField saliency;                          // n; empty where nothing is known of the shape
  std::vector<std::vector<std::int32_t>> picks;  // per participant: the points picked, in the file's order
  bool simulated = false;                        // made by the program: says nothing about people
};

inline constexpr int kHistogramBins = 100;

// Density histogram over [0, 1] of min-max-normalised values: sums to 100. [tasse2016]
using Histogram = std::array<double, kHistogramBins>;

// Agreement of one saliency map with the ground truth. [tasse2016]
struct Scores {
  std::vector<double> values;  // [metric], in the order of the metric table; NaN where undefined
  std::int64_t n_points = 0;
  std::int64_t n_picks = 0;  // distinct points picked
};

// Entry n - 1: how well n people predict n others, the mean over random draws of both. [tasse2016]
using HumanCurve = std::vector<Scores>;

}  // namespace salbench
