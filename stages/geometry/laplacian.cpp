// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/geometry/laplacian.h"

#include "stages/core/check.h"
#include "stages/core/parallel.h"

namespace salbench {
namespace {

// next[i] = factor * (mean over i and its neighbours) - subtracted[i]; `subtracted` may be `next`.
void set_means(ScalarField& next, const ScalarField& values, const Adjacency& adjacency, double factor,
               const ScalarField* subtracted) {
  parallel_ranges(values.size(), kPointGrain, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const std::span<const std::int32_t> ring = adjacency.of(i);
      const double count = static_cast<double>(ring.size()) + 1;
      double mean = values[i] / count;  // quotients first: sums of huge values overflow
      for (const std::int32_t neighbour : ring) mean += values[index(neighbour)] / count;
      next[i] = subtracted == nullptr ? mean : factor * mean - (*subtracted)[i];
    }
  });
}

}  // namespace

ScalarField smoothed_by_steps(ScalarField values, const Adjacency& adjacency, std::int32_t steps) {
  CHECK_EQ(values.size(), adjacency.size());
  ScalarField next(values.size());
  for (std::int32_t step = 0; step < steps; ++step) {
    set_means(next, values, adjacency, 1, nullptr);
    values.swap(next);
  }
  return values;
}

ScalarField smoothed_by_many_steps(ScalarField values, const Adjacency& adjacency, std::int32_t steps) {
  CHECK_EQ(values.size(), adjacency.size());
  CHECK_GT(steps, 0);
  constexpr double kNoWeight = 1e-18;  // of the most frequent end
  ScalarField polynomial = std::move(values), next(polynomial.size()), sum(polynomial.size(), 0);
  set_means(next, polynomial, adjacency, 1, nullptr);
  double weight = 1, total = 0;  // of the walks that end at `degree`
  for (std::int32_t degree = 0; weight > kNoWeight; ++degree) {
    if ((steps - degree) % 2 == 0) {
      const double both_ways = degree == 0 ? weight : 2 * weight;
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += both_ways * polynomial[i];
      total += both_ways;
      weight *= static_cast<double>(steps - degree) / (static_cast<double>(steps) + degree + 2);
    }
    polynomial.swap(next);
    set_means(next, polynomial, adjacency, 2, &next);
  }
  for (double& value : sum) value /= total;
  return sum;
}

}  // namespace salbench
