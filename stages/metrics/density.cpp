// SPDX-License-Identifier: GPL-3.0-or-later
// All scores in two passes over the points, one for the sums that densities are scaled by: a sum in the order
// of the points waits for each addition, and those of one pass wait together. Logarithms are what the rest
// costs: they are taken a block at a time, so that no sum is put aside for the call, and once for all points
// where both fields are 0: nobody marked most of a shape.
#include "stages/metrics/density.h"

#include <algorithm>
#include <cmath>

#include "stages/core/check.h"
#include "stages/core/field.h"

namespace salbench {
namespace {

// The weighed sum of a field, which its density is divided by.
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
Density of_map(std::span<const double> map, Density scaled, const Measure& measure) {
  return is_constant(map, measure) ? Density{0, measure.unit / measure.total} : scaled;
}

// People who marked nothing say nothing.
Density of_truth(std::span<const double> saliency, Density scaled, const Measure& measure) {
  for (std::size_t i = 0; i < saliency.size(); ++i)
    if (measure.weight[i] > 0 && saliency[i] != 0) return scaled;
  return {};
}

template <Density (*one)(std::span<const double>, Density, const Measure&)>
Densities both(std::span<const double> field, const WeighedSum& weighed, const Measures& measures) {
  const bool negative = has_negative(field);
  Densities densities;
  for (const Weighting weighting : {Weighting::vertex, Weighting::area}) {
    const Measure& measure = measures[weighting];
    if (measure.empty()) continue;
    densities[static_cast<std::size_t>(weighting)] =
        one(field, negative ? Density{} : scaled_by(weighed, weighting, measure), measure);
  }
  return densities;
}

// Both densities of a field where it has some value.
struct DensitiesOf {
  explicit DensitiesOf(const Densities& densities)
      : scale(densities[0].scale, densities[1].scale), offset(densities[0].offset, densities[1].offset) {}
  PerWeighting operator()(double value) const { return scale * value + offset; }

  PerWeighting scale, offset;
};

// Map and ground truth.
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
  WeighedSum smoothed_map{kValueFloor}, smoothed_saliency{kValueFloor}, saliency, normalised_map,
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

// In place, of what is defined. `of_zeros` is the ratio where both fields are 0, the most frequent one.
void take_logarithms(std::span<PerWeighting> ratios, const PerWeighting& of_zeros,
                     const Distributions& distributions) {
  for (const std::size_t weighting : {0U, 1U}) {
    if (!distributions.defined(weighting)) continue;
    const auto k = static_cast<Eigen::Index>(weighting);
    const double logarithm_of_zeros = std::log(of_zeros[k]);
    double last = 1, logarithm = 0;
    for (PerWeighting& ratio : ratios) {
      if (ratio[k] == of_zeros[k]) {
        ratio[k] = logarithm_of_zeros;
        continue;
      }
      if (ratio[k] != last) {
        last = ratio[k];
        logarithm = std::log(last);
      }
      ratio[k] = logarithm;
    }
  }
}

// Sums over the points. What a point adds is computed for both weightings at once.
class ScoreSums {
 public:
  ScoreSums(const DensityInput& in, const Measures& measures, const AllDistributions& all)
      : in_(in), measures_(measures), all_(all) {}

  // Points from `first` on, at most a block.
  void add(std::size_t first, std::size_t count) {
    set_logarithms(first, count);
    for (std::size_t k = 0; k < count; ++k) add(measures_.weight(first + k), terms_of(first + k, k));
  }

  static constexpr std::size_t kBlock = 256;
  PerWeighting kl{0, 0}, kl_smoothed{0, 0}, sim{0, 0}, sim_of_normalised{0, 0};

 private:
  // Terms of one point in each sum, before they are multiplied by its weight.
  struct Terms {
    PerWeighting g, log_ratio, smoothed_g, smoothed_log_ratio, common, normalised_common;
  };

  PerWeighting ratio(double map, double saliency) const {
    return kDensityFloor + all_.raw.g(saliency) / (all_.raw.p(map) + kDensityFloor);
  }
  PerWeighting smoothed_ratio(double map, double saliency) const {
    return all_.smoothed.g(saliency) / all_.smoothed.p(map);
  }

  void set_logarithms(std::size_t first, std::size_t count) {
    for (std::size_t k = 0; k < count; ++k) {
      const double map = in_.map[first + k], saliency = in_.saliency[first + k];
      log_ratios_[k] = ratio(map, saliency);
      smoothed_log_ratios_[k] = smoothed_ratio(map, saliency);
    }
    take_logarithms(std::span(log_ratios_).first(count), ratio(0, 0), all_.raw);
    take_logarithms(std::span(smoothed_log_ratios_).first(count), smoothed_ratio(0, 0), all_.smoothed);
  }

  Terms terms_of(std::size_t i, std::size_t in_block) const {
    const PerWeighting g = all_.raw.g(in_.saliency[i]);
    return {g,
            log_ratios_[in_block],
            all_.smoothed.g(in_.saliency[i]),
            smoothed_log_ratios_[in_block],
            all_.raw.p(in_.map[i]).min(g),
            all_.normalised.p(in_.normalised_map[i]).min(all_.normalised.g(in_.normalised_saliency[i]))};
  }

  void add(const PerWeighting& weight, const Terms& terms) {
    kl += weight * terms.g * terms.log_ratio;
    kl_smoothed += weight * terms.smoothed_g * terms.smoothed_log_ratio;
    sim += weight * terms.common;
    sim_of_normalised += weight * terms.normalised_common;
  }

  const DensityInput& in_;
  const Measures& measures_;
  const AllDistributions& all_;
  std::array<PerWeighting, kBlock> log_ratios_, smoothed_log_ratios_;  // of the block
};

WeighedSum weighed_sum(std::span<const double> field, const Measures& measures, double added) {
  CHECK_EQ(field.size(), measures.size());
  WeighedSum weighed{added};
  for (std::size_t i = 0; i < field.size(); ++i) weighed.add(measures.weight(i), field[i]);
  return weighed;
}

}  // namespace

Densities densities_of_map(std::span<const double> map, const Measures& measures, double added) {
  return both<of_map>(map, weighed_sum(map, measures, added), measures);
}

Densities densities_of_truth(std::span<const double> saliency, const Measures& measures, double added) {
  return both<of_truth>(saliency, weighed_sum(saliency, measures, added), measures);
}

double divergence(std::span<const double> map, std::span<const double> saliency,
                  const DivergenceFloors& floors, Weighting weighting, const Measures& measures) {
  const auto k = static_cast<std::size_t>(weighting);
  const Density of_map = densities_of_map(map, measures, floors.values)[k];
  const Density of_truth = densities_of_truth(saliency, measures, floors.values)[k];
  if (!of_map.defined() || !of_truth.defined()) return kUndefined;
  const Measure& measure = measures[weighting];
  double sum = 0;
  for (std::size_t i = 0; i < map.size(); ++i) {
    const double p = of_map.of(map[i]) + floors.densities, g = of_truth.of(saliency[i]) + floors.densities;
    sum += measure.weight[i] * g * std::log(floors.quotient + g / (p + floors.quotient));
  }
  return sum / measure.unit;
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
    const double unit = measures[static_cast<Weighting>(weighting)].unit;
    return DensityScores{
        .kl = all.raw.value_if_defined(sums.kl[k] / unit, weighting),
        .kl_smoothed = all.smoothed.value_if_defined(sums.kl_smoothed[k] / unit, weighting),
        .sim = all.raw.value_if_defined(sums.sim[k] / unit, weighting),
        .sim_of_normalised = all.normalised.value_if_defined(sums.sim_of_normalised[k] / unit, weighting)};
  };
  return {of(0), of(1)};
}

std::array<Errors, 2> errors(std::span<const double> normalised_map,
                             std::span<const double> normalised_saliency, const Measures& measures) {
  PerWeighting squares{0, 0}, magnitudes{0, 0};
  for (std::size_t i = 0; i < measures.size(); ++i) {
    const double difference = normalised_map[i] - normalised_saliency[i];
    squares += measures.weight(i) * (difference * difference);
    magnitudes += measures.weight(i) * std::abs(difference);
  }
  // A constant field stays as it is when it is normalised.
  const bool constant_truth = is_constant(normalised_saliency) && normalised_saliency[0] != 0;
  const auto of = [&](Weighting weighting) {
    const auto k = static_cast<Eigen::Index>(weighting);
    const double total = measures[weighting].total;
    return constant_truth ? Errors{kUndefined, kUndefined}
                          : Errors{squares[k] / total, magnitudes[k] / total};  // NaN over nothing
  };
  return {of(Weighting::vertex), of(Weighting::area)};
}

double information_gain(const Distributed& map, const Distributed& baseline,
                        std::span<const std::int32_t> picked) {
  if (!map.density.defined() || !baseline.density.defined() || picked.empty()) return kUndefined;
  double sum = 0;
  for (const std::int32_t i : picked)
    sum += std::log2(kDensityFloor + map.at(i)) - std::log2(kDensityFloor + baseline.at(i));
  return sum / static_cast<double>(picked.size());
}

}  // namespace salbench
