// SPDX-License-Identifier: GPL-3.0-or-later
// All scores in two passes over the points, one for the sums that densities are scaled by: a sum in the order
// of the points waits for each addition, and those of one pass wait together. Logarithms are what the rest
// costs: a block of them at a time, so that no sum is put aside for the call, and of equal numbers in a row,
// as where nobody marked anything, only one.
#include "stages/metrics/density.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "stages/core/check.h"

namespace salbench {
namespace {

constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();
constexpr double kEpsilon = 2.2204e-16;  // as the MIT benchmark has it: Matlab's eps to five digits
constexpr double kSmoothing = 1e-12;

// What densities are scaled by.
struct WeighedSum {
  double smoothing = 0;
  PerWeighting sum = PerWeighting::Zero();

  void add(const PerWeighting& weight, double value) { sum += weight * (value + smoothing); }
};

bool has_negative(std::span<const double> field) {
  return !field.empty() &&
         Eigen::Map<const Eigen::ArrayXd>(field.data(), static_cast<Eigen::Index>(field.size())).minCoeff() <
             0;
}

Density scaled_by(const WeighedSum& weighed, Weighting weighting, const Measure& measure) {
  const double scale = measure.unit / weighed.sum[static_cast<Eigen::Index>(weighting)];
  return {scale, weighed.smoothing * scale};
}

// A model may call all points equally salient, and in any number.
Density of_map(std::span<const double> map, const WeighedSum& weighed, Weighting weighting,
               const Measure& measure) {
  if (is_constant(map, measure)) return {0, measure.unit / measure.total};
  return has_negative(map) ? Density{} : scaled_by(weighed, weighting, measure);
}

// People who marked nothing say nothing.
Density of_truth(std::span<const double> saliency, const WeighedSum& weighed, Weighting weighting,
                 const Measure& measure) {
  for (std::size_t i = 0; i < saliency.size(); ++i)
    if (measure.weight[i] > 0 && saliency[i] != 0)
      return has_negative(saliency) ? Density{} : scaled_by(weighed, weighting, measure);
  return {};
}

template <Density (*one)(std::span<const double>, const WeighedSum&, Weighting, const Measure&)>
Densities both(std::span<const double> field, const WeighedSum& weighed, const Measures& measures) {
  Densities densities;
  for (const Weighting weighting : {Weighting::vertex, Weighting::area})
    if (!measures[weighting].empty())
      densities[static_cast<std::size_t>(weighting)] = one(field, weighed, weighting, measures[weighting]);
  return densities;
}

// Both densities of a field where it has some value.
struct DensitiesOf {
  explicit DensitiesOf(const Densities& densities)
      : scale(densities[0].scale, densities[1].scale), offset(densities[0].offset, densities[1].offset) {}
  PerWeighting operator()(double value) const { return scale * value + offset; }

  PerWeighting scale, offset;
};

// Of map and ground truth.
struct Distributions {
  Distributions(const Densities& map, const Densities& truth) : p(map), g(truth) {}

  bool defined(std::size_t weighting) const {
    const auto k = static_cast<Eigen::Index>(weighting);
    return !std::isnan(p.scale[k]) && !std::isnan(g.scale[k]);
  }
  double value_if_defined(double value, std::size_t weighting) const {
    return defined(weighting) ? value : kUndefined;
  }

  DensitiesOf p, g;
};

struct AllDistributions {
  Distributions raw, smoothed, normalised;
};

AllDistributions distributions_of(const DensityInput& in, const Measures& measures) {
  WeighedSum smoothed_map{kSmoothing}, smoothed_saliency{kSmoothing}, saliency, normalised_map,
      normalised_saliency;
  for (std::size_t i = 0; i < measures.size(); ++i) {
    const PerWeighting weight = measures.weight(i);
    smoothed_map.add(weight, in.map[i]);
    saliency.add(weight, in.saliency[i]);
    smoothed_saliency.add(weight, in.saliency[i]);
    normalised_map.add(weight, in.normalised_map[i]);
    normalised_saliency.add(weight, in.normalised_saliency[i]);
  }
  return {{in.map_densities, both<of_truth>(in.saliency, saliency, measures)},
          {both<of_map>(in.map, smoothed_map, measures),
           both<of_truth>(in.saliency, smoothed_saliency, measures)},
          {both<of_map>(in.normalised_map, normalised_map, measures),
           both<of_truth>(in.normalised_saliency, normalised_saliency, measures)}};
}

// In place, of what is defined.
void take_logarithms(std::span<PerWeighting> ratios, const Distributions& distributions) {
  for (const std::size_t weighting : {0U, 1U}) {
    if (!distributions.defined(weighting)) continue;
    const auto k = static_cast<Eigen::Index>(weighting);
    double last = 1, logarithm = 0;
    for (PerWeighting& ratio : ratios) {
      if (ratio[k] != last) {
        last = ratio[k];
        logarithm = std::log(last);
      }
      ratio[k] = logarithm;
    }
  }
}

// Sums over the points, of which densities of both fields are known.
class ScoreSums {
 public:
  ScoreSums(const DensityInput& in, const Measures& measures, const AllDistributions& all)
      : in_(in), measures_(measures), all_(all) {}

  // Points from `first` on, at most a block.
  void add(std::size_t first, std::size_t count) {
    const auto& [raw, smoothed, normalised] = all_;
    const std::span<PerWeighting> ratios = std::span(ratios_).first(count);
    const std::span<PerWeighting> smoothed_ratios = std::span(smoothed_ratios_).first(count);
    for (std::size_t k = 0; k < count; ++k) {
      const double map = in_.map[first + k], saliency = in_.saliency[first + k];
      const PerWeighting g = raw.g(saliency), smoothed_g = smoothed.g(saliency);
      ratios[k] = kEpsilon + g / (raw.p(map) + kEpsilon);
      smoothed_ratios[k] = smoothed_g / smoothed.p(map);
    }
    take_logarithms(ratios, raw);
    take_logarithms(smoothed_ratios, smoothed);
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t i = first + k;
      const PerWeighting weight = measures_.weight(i), g = raw.g(in_.saliency[i]);
      kl += weight * g * ratios[k];
      kl_smoothed += weight * smoothed.g(in_.saliency[i]) * smoothed_ratios[k];
      sim += weight * raw.p(in_.map[i]).min(g);
      const double map_to_1 = in_.normalised_map[i], saliency_to_1 = in_.normalised_saliency[i];
      sim_of_normalised += weight * normalised.p(map_to_1).min(normalised.g(saliency_to_1));
      const double difference = map_to_1 - saliency_to_1;
      squares += weight * (difference * difference);
      magnitudes += weight * std::abs(difference);
    }
  }

  static constexpr std::size_t kBlock = 128;
  PerWeighting kl{0, 0}, kl_smoothed{0, 0}, sim{0, 0}, sim_of_normalised{0, 0}, squares{0, 0},
      magnitudes{0, 0};

 private:
  const DensityInput& in_;
  const Measures& measures_;
  const AllDistributions& all_;
  std::array<PerWeighting, kBlock> ratios_, smoothed_ratios_;
};

}  // namespace

Densities densities_of_map(std::span<const double> map, const Measures& measures) {
  CHECK_EQ(map.size(), measures.size());
  WeighedSum weighed;
  for (std::size_t i = 0; i < map.size(); ++i) weighed.add(measures.weight(i), map[i]);
  return both<of_map>(map, weighed, measures);
}

std::array<DensityScores, 2> density_scores(const DensityInput& in, const Measures& measures) {
  const std::size_t n = measures.size();
  for (const auto& field : {in.map, in.saliency, in.normalised_map, in.normalised_saliency})
    CHECK_EQ(field.size(), n);
  const AllDistributions all = distributions_of(in, measures);
  ScoreSums sums(in, measures, all);
  for (std::size_t i = 0; i < n; i += ScoreSums::kBlock) sums.add(i, std::min(n - i, ScoreSums::kBlock));
  const auto of = [&](std::size_t weighting) {
    const auto k = static_cast<Eigen::Index>(weighting);
    const Measure& measure = measures[static_cast<Weighting>(weighting)];
    const double unit = measure.unit, total = measure.total;
    return DensityScores{
        .kl = all.raw.value_if_defined(sums.kl[k] / unit, weighting),
        .kl_smoothed = all.smoothed.value_if_defined(sums.kl_smoothed[k] / unit, weighting),
        .sim = all.raw.value_if_defined(sums.sim[k] / unit, weighting),
        .sim_of_normalised = all.normalised.value_if_defined(sums.sim_of_normalised[k] / unit, weighting),
        .mse = sums.squares[k] / total,  // NaN over nothing
        .mae = sums.magnitudes[k] / total};
  };
  return {of(0), of(1)};
}

double information_gain(std::span<const double> map, const Density& density,
                        std::span<const std::int32_t> picked, const Measure& measure) {
  if (!density.defined() || picked.empty()) return kUndefined;
  const double baseline = std::log2(kEpsilon + measure.unit / measure.total);
  double sum = 0;
  for (const std::int32_t i : picked)
    sum += std::log2(kEpsilon + density.of(map[static_cast<std::size_t>(i)])) - baseline;
  return sum / static_cast<double>(picked.size());
}

}  // namespace salbench
