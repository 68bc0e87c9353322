// SPDX-License-Identifier: GPL-3.0-or-later
// Maps as probability densities of what people mark. A map is not made to be one: by information gain, KL and
// SIM a constant map comes before good models. What the literature does first is fitted here: how values
// become density, a blur, and the centre bias. [kummerer2015, kummerer2018]
//
// The density of point i is proportional to exp(f(v_i) + c(d_i)). v is the map, blurred along the surface and
// scaled to [0, 1]; d is the distance from the centroid in R. f and c are linear between knots, f does not
// decrease. Both are fitted to shapes of other classes, or other meshes, than the shape they are applied to.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "stages/core/fitted.h"
#include "stages/core/options.h"
#include "stages/core/types.h"
#include "stages/geometry/mesh_ops.h"

namespace salbench {

enum class FoldGroup : std::uint8_t { item_class, mesh };
template <>
struct EnumNames<FoldGroup> {
  static constexpr std::array<std::string_view, 2> names{"class", "mesh"};
};

struct FittingOptions {
  std::int32_t folds = 10;
  FoldGroup by = FoldGroup::item_class;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("folds", self.folds,
          {"parts of a set; each is scored by what was fitted to the others", "parts", between(2, 1000)});
    visit("by", self.by, {"what stays together in a part; a mesh without a class is a class of its own"});
  }
};

inline constexpr std::array kBlurWidths = {0.0, 0.02, 0.04, 0.08};  // standard deviations, in R

// The part of a set that a group of shapes belongs to: whatever else the set has.
std::int32_t fold_of(const std::string& group, std::int32_t folds, std::uint64_t seed);

// The marks are the picks, or the saliency where none are known. NaN in a map counts
// as 0. Points that nobody saw do not count. Throws InputError for an infinite value, and as
// distances_from_centroid does.
DensityCounts density_counts(FieldView map, Points points, const Adjacency& adjacency,
                             const GroundTruth& truth, std::int32_t fold);

// For each fold the fit to the shapes of all others, by the blur of the largest mean log-likelihood.
// A small penalty on f and c makes it unique, and finite where nobody marked anything.
DensityFits fit_densities(const std::vector<std::shared_ptr<const DensityCounts>>& shapes,
                          std::int32_t folds);

// n values > 0, the largest 1; none if nothing was fitted.
ScalarField fitted_density(FieldView map, Points points, const Adjacency& adjacency, const DensityFit& fit);

}  // namespace salbench
