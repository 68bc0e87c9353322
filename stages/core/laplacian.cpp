// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/core/laplacian.h"

#include "stages/core/check.h"

namespace salbench {

ScalarField smoothed_by_steps(ScalarField values, const Adjacency& adjacency, std::int32_t steps) {
  CHECK_EQ(values.size(), adjacency.size());
  ScalarField next(values.size());
  for (std::int32_t step = 0; step < steps; ++step) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::span<const std::int32_t> ring = adjacency.of(i);
      const double count = static_cast<double>(ring.size()) + 1;
      double mean = values[i] / count;  // quotients first: sums of huge values overflow
      for (const std::int32_t neighbour : ring) mean += values[index(neighbour)] / count;
      next[i] = mean;
    }
    values.swap(next);
  }
  return values;
}

}  // namespace salbench
