// RS, the model that knows nothing: what a score means without any agreement.
#pragma once

#include "stages/core/options.h"
#include "stages/models/model.h"

namespace salbench {

using RsOptions = NoOptions;

// Uniform in [0, 1), a function of (seed, item) alone. [tasse2016]
ScalarField rs_saliency(const ModelInput& input, const RsOptions& options);

}  // namespace salbench
