// PS, saliency by principal components: how far a point's descriptor lies along the direction in which the
// descriptors of the shape vary most.
#pragma once

#include "stages/core/options.h"
#include "stages/models/model.h"

namespace salbench {

struct PsOptions {
  bool absolute = false;

  static PsOptions text() { return {.absolute = true}; }  // the paper's words

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("absolute", self.absolute, {"take the magnitude of the projection, as the paper's text has it"});
  }
};

// Projection of the mean-centred descriptors on their first principal axis, its sign such that flat places
// are low; 0 everywhere where all descriptors are equal. Reads input.fpfh. [tasse2016]
ScalarField ps_saliency(const ModelInput& input, const PsOptions& options);

}  // namespace salbench
