// SPDX-License-Identifier: GPL-3.0-or-later
// The unit of inference: what one observation is. The views of a mesh share its form and its participants:
// they are no independent shapes, and intervals that take them for such are too narrow.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "stages/core/options.h"

namespace salbench {

enum class Observation : std::uint8_t {
  mesh,        // a mesh, its score being the mean over its scans; a point cloud
  item_class,  // a class of shapes: for statements about kinds of shapes
  shape        // a mesh, scan or point cloud: the paper's reading, which takes 12 scans for 12 shapes
};
template <>
struct EnumNames<Observation> {
  static constexpr std::array<std::string_view, 3> names{"mesh", "class", "shape"};
};

struct StatisticsOptions {
  Observation unit = Observation::mesh;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("unit", self.unit, {"what counts as one observation in intervals, tests and ranks"});
  }
};

}  // namespace salbench
