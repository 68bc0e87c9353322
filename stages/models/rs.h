// SPDX-License-Identifier: GPL-3.0-or-later
// RS, random saliency: the baseline without any agreement.
#pragma once

#include "stages/core/options.h"
#include "stages/core/rng.h"
#include "stages/core/types.h"

namespace salbench {

using RsOptions = NoOptions;

// Uniform in [0, 1), depends on the random source and the number of points alone. [tasse2016]
ScalarField rs_saliency(Points points, const RandomSource& random, const RsOptions& options);

}  // namespace salbench
