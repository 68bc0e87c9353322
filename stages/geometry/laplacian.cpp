// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/geometry/laplacian.h"

#include "stages/core/check.h"
#include "stages/core/parallel.h"

namespace salbench {
namespace {

// next[i] = mean of `values` over i and its neighbours.
void set_means(ScalarField& next, const ScalarField& values, const Adjacency& adjacency) {
  parallel_ranges(values.size(), kPointGrain, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const std::span<const std::int32_t> ring = adjacency.of(i);
      const double count = static_cast<double>(ring.size()) + 1;
      double mean = values[i] / count;  // divides first: sums of huge values overflow
      for (const std::int32_t neighbour : ring) mean += values[index(neighbour)] / count;
      next[i] = mean;
    }
  });
}

}  // namespace

ScalarField smoothed_by_steps(ScalarField values, const Adjacency& adjacency, std::int32_t steps) {
  CHECK_EQ(values.size(), adjacency.size());
  ScalarField next(values.size());
  for (std::int32_t step = 0; step < steps; ++step) {
    set_means(next, values, adjacency);
    values.swap(next);
  }
  return values;
}

}  // namespace salbench
