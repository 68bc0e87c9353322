// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/stats/resampling.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "stages/core/check.h"
#include "stages/core/parallel.h"
#include "stages/core/rng.h"
#include "stages/stats/distributions.h"

namespace salbench {
namespace {

constexpr std::size_t kResampleGrain = 125;  // a stream of random numbers each
// The sums of so many resamples and columns stay in a core's first cache while the units pass by.
constexpr std::size_t kResampleTile = 25, kColumnTile = 64;

// The columns less their first value, so that a constant one resamples to itself exactly.
Columns relative_to_first(Columns columns) {
  const std::vector<double> first(columns.values.begin(),
                                  columns.values.begin() + static_cast<std::ptrdiff_t>(columns.count));
  for (std::size_t i = 0; i < columns.values.size(); ++i) columns.values[i] -= first[i % columns.count];
  return columns;
}

// Adds up the columns over each resample: sums, resamples x columns. Units are added in their order.
void add_resampled(const Columns& columns, std::span<const std::uint8_t> times, double* sums) {
  const std::size_t n = columns.units(), resamples = times.size() / n;
  for (std::size_t c = 0; c < columns.count; c += kColumnTile) {
    const std::size_t width = std::min(kColumnTile, columns.count - c);
    for (std::size_t u = 0; u < n; ++u) {
      const double* row = columns.values.data() + u * columns.count + c;
      for (std::size_t r = 0; r < resamples; ++r) {
        const auto drawn = static_cast<double>(times[r * n + u]);
        double* sum = sums + r * columns.count + c;
        for (std::size_t k = 0; k < width; ++k) sum[k] += drawn * row[k];
      }
    }
  }
}

// Third moment over the second to the power 3/2, divided by 6: the jackknife's acceleration of a mean.
double acceleration(std::span<const double> sample, double mean) {
  double squares = 0, cubes = 0;
  for (const double value : sample) {
    const double d = value - mean;
    squares += d * d;
    cubes += d * d * d;
  }
  return cubes / (6 * std::pow(squares, 1.5));
}

// Share of the resampled means below the mean; those equal to it count one half.
double share_below(std::span<const double> resampled, double mean) {
  double twice = 0;
  for (const double value : resampled) twice += (value < mean ? 1 : 0) + (value <= mean ? 1 : 0);
  return twice / (2 * static_cast<double>(resampled.size()));
}

}  // namespace

std::vector<double> Columns::column(std::size_t c) const {
  std::vector<double> result(units());
  for (std::size_t u = 0; u < result.size(); ++u) result[u] = at(u, c);
  return result;
}

std::vector<double> Columns::means() const {
  CHECK_LT(0U, units());
  std::vector<double> result(count, 0.0);
  for (std::size_t u = 0; u < units(); ++u)
    for (std::size_t c = 0; c < count; ++c) result[c] += at(u, c) - at(0, c);
  for (std::size_t c = 0; c < count; ++c) result[c] = at(0, c) + result[c] / static_cast<double>(units());
  return result;
}

Bootstrap::Bootstrap(std::uint64_t seed, std::size_t resamples) : seed_(seed), resamples_(resamples) {}

const std::vector<std::uint8_t>& Bootstrap::times_drawn(std::size_t units) const {
  const std::scoped_lock lock(making_);
  std::vector<std::uint8_t>& times = times_drawn_[units];
  if (!times.empty()) return times;
  times.resize(resamples_ * units);
  parallel_ranges(resamples_, kResampleGrain, [&](std::size_t first, std::size_t last) {
    Rng rng(seed_, "bootstrap", std::to_string(first));
    for (std::size_t r = first; r < last; ++r)
      for (std::size_t drawn = 0; drawn < units; ++drawn) {
        std::uint8_t& of_unit = times[r * units + rng.below(units)];
        CHECK_LT(of_unit, 255);  // of n draws of n units
        ++of_unit;
      }
  });
  return times;
}

Columns Bootstrap::means(const Columns& columns) const {
  const std::size_t n = columns.units(), count = columns.count;
  CHECK_LT(0U, n);
  const std::span<const std::uint8_t> times = times_drawn(n);
  const Columns relative = relative_to_first(columns);
  Columns means{count, std::vector<double>(resamples_ * count, 0.0)};
  parallel_ranges(resamples_, kResampleTile, [&](std::size_t first, std::size_t last) {
    add_resampled(relative, times.subspan(first * n, (last - first) * n),
                  means.values.data() + first * count);
    for (std::size_t i = first * count; i < last * count; ++i)
      means.values[i] = columns.at(0, i % count) + means.values[i] / static_cast<double>(n);
  });
  return means;
}

Interval bca_interval(std::span<const double> sample, std::span<const double> resampled_means) {
  const Summary summary = summarise(sample);
  CHECK_EQ(summary.n_undefined, 0);
  if (!(summary.sd > 0) || resampled_means.empty()) return {};
  const double share = share_below(resampled_means, summary.mean);
  if (share <= 0 || share >= 1) return {};
  const double bias = normal_quantile(share), a = acceleration(sample, summary.mean);
  std::vector<double> means(resampled_means.begin(), resampled_means.end());
  const auto end_at = [&](double level) {
    const double z = bias + normal_quantile(level);
    return quantile_in_place(means, normal_cdf(bias + z / (1 - a * z)));
  };
  constexpr double kTail = (1 - kConfidence) / 2;
  return {end_at(kTail), end_at(1 - kTail)};
}

Interval percentile_interval(std::vector<double> resampled, std::size_t units) {
  const bool known = std::ranges::none_of(resampled, [](double value) { return std::isnan(value); });
  if (units < kMinUnitsOfPercentiles || resampled.empty() || !known) return {};
  const auto n = static_cast<double>(units);
  const double z = std::sqrt(n / (n - 1)) * student_upper_quantile((1 - kConfidence) / 2, n - 1);
  const double position = normal_cdf(-z) * static_cast<double>(resampled.size() - 1);
  const auto value_at = [&](std::size_t place) {
    const auto at = resampled.begin() + static_cast<std::ptrdiff_t>(place);
    std::nth_element(resampled.begin(), at, resampled.end());
    return *at;
  };
  const auto below = static_cast<std::size_t>(position);
  const Interval interval{value_at(below), value_at(resampled.size() - 1 - below)};
  return interval.low == interval.high && std::isfinite(interval.low) ? Interval{} : interval;
}

}  // namespace salbench
