#include "stages/models/rs.h"

#include <algorithm>

namespace salbench {

ScalarField rs_saliency(const ModelInput& input, const RsOptions&) {
  Rng rng = input.rng("RS");
  ScalarField saliency(input.points.size());
  std::generate(saliency.begin(), saliency.end(), [&] { return rng.uniform(); });
  return saliency;
}

}  // namespace salbench
