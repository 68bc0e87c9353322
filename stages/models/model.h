// What a saliency model sees, and the one signature all models share:
//
//   ScalarField xs_saliency(const ModelInput& input, const XsOptions& options);
//
// The result has one value per point, any finite range, larger = more salient; it is matched and normalised
// later, never here. A model must not depend on threads or time. It throws InputError for a shape that it
// cannot handle and has no documented fallback for.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "stages/core/rng.h"
#include "stages/core/types.h"

namespace salbench {

// Only the parts that the model's catalog row names are filled; the others are empty.
struct ModelInput {
  std::span<const Vec3> points = {};     // n x 3, always there
  std::span<const Vec3> normals = {};    // n x 3, unit
  std::span<const Triangle> faces = {};  // f x 3; of a scan: its partial mesh
  const Descriptors* fpfh = nullptr;     // n x 33, the shared descriptors of the shape
  std::uint64_t seed = 0;                // with the item's name: what random numbers depend on
  std::string_view item = {};

  Rng rng(std::string_view stage) const { return Rng(seed, stage, item); }
};

}  // namespace salbench
