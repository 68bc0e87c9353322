// SPDX-License-Identifier: GPL-3.0-or-later
// How much each point of a shape counts. Published work counts vertices; on a mesh whose vertices are spread
// unevenly that weighs finely meshed parts more, and the same surface meshed otherwise gets other values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

inline constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();  // of a metric

enum class Weighting : std::uint8_t { vertex, area };

struct Measure {
  std::vector<double> weight;  // n, >= 0: 1 per vertex, or an area in some unit
  double total = 0;            // sum of the weights
  // Unit of a density: one vertex, as published, or the area of the whole surface. A density per area
  // does not change when a vertex is replaced by two of half its area.
  double unit = 1;

  std::size_t size() const { return weight.size(); }
  bool empty() const { return !(total > 0); }  // nothing to average over
};

Measure vertex_measure(std::size_t n);
// n, or none: an empty measure. Areas that are very large or small are multiplied by a power of four, for
// which no metric changes: products of three weights would overflow or vanish. Throws InputError for one that
// is not finite.
Measure area_measure(std::span<const double> areas);

struct SurfaceGraph;

// What metrics read of a shape beside map and ground truth: both measures, and what some of them need.
struct Measures {
  // areas: n, or none, and nothing is weighed by them; centre: n values >= 0, or none.
  Measures(std::size_t n, std::span<const double> areas, std::span<const double> centre = {});

  const Measure& operator[](Weighting weighting) const {
    return weighting == Weighting::vertex ? vertex : area;
  }
  std::size_t size() const { return vertex.size(); }
  Measures at(std::span<const std::int32_t> points) const;  // of these points alone

  Measure vertex, area;
  ScalarField centre_bias;  // not a density yet: relative to each other
  ScalarField negatives;    // n weights >= 0 of the points as negatives of sauc; empty if not known
  std::shared_ptr<const SurfaceGraph> surface;  // none if not known
};

// True if the field has one value wherever the weight is positive, and if no weight is.
bool is_constant(std::span<const double> field, const Measure& measure);

}  // namespace salbench
