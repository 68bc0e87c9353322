// SPDX-License-Identifier: GPL-3.0-or-later
// PS, saliency by principal components: the position of a point's descriptor along the direction in which the
// descriptors of the shape vary most.
#pragma once

#include "stages/core/options.h"
#include "stages/core/types.h"
#include "stages/models/about.h"

namespace salbench {

inline constexpr ModelAbout kPsAbout = {
    .name = "Saliency by principal components",
    .authors = "Tasse, Kosinka, Dodgson",
    .year = "2016",
    .link = "https://doi.org/10.1145/3005358.3005380",
    .key = "tasse2016",
    .values = ": the descriptor along the direction in which descriptors vary most",
    .by_default = true,
};

struct PsOptions {
  bool absolute = false;

  static PsOptions text() { return {.absolute = true}; }  // as in the paper's text

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("absolute", self.absolute, {"take the magnitude of the projection, as the paper's text has it"});
  }
};

// Projection of the mean-centred descriptors (n x 33) on their first principal axis, signed such that flat
// regions are low; 0 everywhere if all descriptors are equal. [tasse2016]
ScalarField ps_saliency(Points points, const Descriptors& fpfh, const PsOptions& options);

}  // namespace salbench
