// SPDX-License-Identifier: GPL-3.0-or-later
// The point of a mesh's surface that is nearest to a place in space.
#pragma once

#include <memory>

#include "stages/geometry/first_hit.h"

namespace salbench {

class NearestFace {
 public:
  // The mesh must outlive it. Throws InputError if no face has an area.
  explicit NearestFace(const Mesh& mesh);
  explicit NearestFace(Mesh&&) = delete;
  ~NearestFace();

  // Its `depth` is the distance. Faces without an area do not count; of equally near ones it is always the
  // same.
  FirstHit to(const Vec3& place) const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace salbench
