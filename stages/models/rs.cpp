// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/rs.h"

#include <algorithm>

namespace salbench {

ScalarField rs_saliency(Points points, const RandomSource& random, const RsOptions&) {
  Rng rng = random.rng("RS");
  ScalarField saliency(points.size());
  std::generate(saliency.begin(), saliency.end(), [&] { return rng.uniform(); });
  return saliency;
}

}  // namespace salbench
