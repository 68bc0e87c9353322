// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/inputs/scale.h"

#include <cstdio>

namespace salbench {
namespace {

// Lengths of the bounding box's diagonal: from an object of a millimetre in metres to one of a kilometre in
// millimetres. Below, files of six decimals, as printf writes them, have less than 1000 steps across a shape.
constexpr double kSmallest = 1e-3, kLargest = 1e6;
// Distance from the origin, in diagonals. Most files are written in single precision, of 24 bits: at 1000
// diagonals it has 16,000 steps across a shape, 100 or less from point to point, and normals turn by degrees.
constexpr double kFarthest = 1000;
constexpr double kSinglePrecision = 16777216;

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

}  // namespace

std::string odd_scale(std::span<const Vec3> points) {
  Eigen::AlignedBox3d box;
  for (const Vec3& p : points) box.extend(p);
  if (box.isEmpty()) return {};
  const double diagonal = box.diagonal().stableNorm();
  const double largest = box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).maxCoeff();
  std::string odd;
  if (diagonal < kSmallest || diagonal > kLargest)
    odd = "the bounding box has a diagonal of " + number(diagonal) + ": check the unit of length";
  if (largest > kFarthest * diagonal)
    odd += std::string(odd.empty() ? "" : "; ") + "coordinates reach " + number(largest / diagonal) +
           " diagonals of the bounding box from the origin: single precision has " +
           number(kSinglePrecision * diagonal / largest) + " steps across the shape";
  return odd;
}

}  // namespace salbench
