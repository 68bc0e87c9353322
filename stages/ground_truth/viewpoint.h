// SPDX-License-Identifier: GPL-3.0-or-later
// Where a shape is looked at from.
#pragma once

#include "stages/core/types.h"

namespace salbench {

struct Viewpoint {
  Vec3 place = Vec3::Zero();  // in the coordinates of the shape
  bool at_infinity = false;   // `place` is the direction towards it, of any length
};

}  // namespace salbench
