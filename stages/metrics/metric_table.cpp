// SPDX-License-Identifier: GPL-3.0-or-later
// The order of the rows is the order of stored scores and of the columns of tables. The paper's metrics come
// first.
#include <cmath>
#include <string>
#include <vector>

#include "stages/core/field.h"
#include "stages/metrics/density.h"
#include "stages/metrics/metrics.h"
#include "stages/metrics/roc.h"

namespace salbench {
namespace {

Splits splits_of(const MetricInput& in) { return {in.options.splits, in.options.thresholds}; }

// The paper's protocol numbers the points, and excludes the first.
double sampled(const MetricInput& in) {
  return sampled_auc(values_at(in.map, in.picked), in.comparison.values_at_points(in.rng), splits_of(in));
}
double borji(const MetricInput& in) {
  return sampled_auc(values_at(in.map, in.picked), in.comparison.quantiles(in.rng), splits_of(in),
                     tenths_of_range(in.map));
}
double judd(const MetricInput& in) {
  return auc_judd(in.map, in.comparison.map_order(), pick_counts(in.picked, in.map.size()));
}

double against(const MetricInput& in, std::span<const double> positives, std::span<const double> negatives) {
  return mann_whitney(in.map, in.comparison.map_order(), positives, negatives);
}
double exact(const MetricInput& in) {
  const ScalarField positives = pick_counts(in.picked, in.map.size());
  return against(in, positives, all_others(positives));
}
double against_all(const MetricInput& in) {
  return against(in, pick_counts(in.picked, in.map.size()), ScalarField(in.map.size(), 1));
}
double shuffled(const MetricInput& in) {
  const ScalarField& negatives = in.comparison.of.measures.negatives;
  if (negatives.empty()) return kUndefined;
  return against(in, pick_counts(in.picked, in.map.size()), negatives);
}
double of_upper_fifth(const MetricInput& in) {
  const ScalarField positives = upper_fifth(in.comparison.saliency(), in.comparison.saliency_order());
  return against(in, positives, all_others(positives));
}

double height_of_picks(const MetricInput& in) {
  return nss(in.map, in.picked, in.comparison.map_moments(), in.options.constant_nss);
}

// The floor applies to maps in [0, 1]; others have their own unit.
std::span<const double> density_map(const MetricInput& in) {
  return is_normalised(in.matching) ? in.comparison.density_map() : in.map;
}

double gain_over(const MetricInput& in, std::span<const double> baseline, const Density& of_baseline) {
  const std::span<const double> map = density_map(in);
  return information_gain({map, density_of_map(map)}, {baseline, of_baseline}, in.picked);
}
double gain(const MetricInput& in) {
  return gain_over(in, in.map, {0, 1 / static_cast<double>(in.map.size())});
}
double gain_over_centre_bias(const MetricInput& in) {
  const ScalarField& bias = in.comparison.of.measures.centre_bias;
  return bias.empty() ? kUndefined : gain_over(in, bias, density_of_map(bias));
}

// Metrics of the saliency values are undefined without saliency.
template <double (*value)(const MetricInput&)>
double of_saliency(const MetricInput& in) {
  return in.comparison.of.raw_saliency.empty() ? kUndefined : value(in);
}

template <const DivergenceFloors& floors>
double of_divergence(const MetricInput& in) {
  return divergence(density_map(in), in.comparison.of.raw_saliency, floors);
}

double intersection(const MetricInput& in) {
  return similarity(density_map(in), in.comparison.of.raw_saliency);
}
double normalised_intersection(const MetricInput& in) {
  return similarity(in.comparison.normalised_density_map(), in.comparison.saliency());
}

double pearson(const MetricInput& in) { return correlation(in.comparison.with_saliency()); }
double pearson_magnitude(const MetricInput& in) { return std::abs(pearson(in)); }
double pearson_by_area(const MetricInput& in) {
  const ScalarField& areas = in.comparison.of.measures.areas;
  return areas.empty() ? kUndefined : correlation(pair_moments(in.map, in.comparison.saliency(), areas));
}
double pearson_of_ranks(const MetricInput& in) {
  const ScalarField ones(in.map.size(), 1);
  return cc(mid_ranks(in.map, in.comparison.map_order(), ones).below,
            mid_ranks(in.comparison.saliency(), in.comparison.saliency_order(), ones).below);
}

template <double InterestPointScores::*value>
double of_interest_points(const MetricInput& in) {
  const auto& surface = in.comparison.of.measures.surface;
  if (!surface || surface->edges.neighbours.empty()) return kUndefined;
  const LocalMaximaOptions peaks{in.options.peak_radius, in.options.peak_height};
  return in.comparison.interest_points(in.picked, peaks, in.options.tolerance).*value;
}

constexpr Range kShare{0, 1}, kCorrelation{-1, 1}, kDivergence{0};
constexpr const char *kDeviations = "standard deviations", *kBits = "bits per pick";

Metric divergence_metric(const char* name, const char* label, const char* added,
                         double (*value)(const MetricInput&)) {
  return {.name = name,
          .label = label,
          .unit = "nats",
          .help = std::string("Kullback-Leibler divergence from the ground truth, ") + added,
          .value = value,
          .range = kDivergence,
          .higher_is_better = false,
          .matching = Matching::none,
          .constant_varies = true};
}

Metric interest_point_metric(const char* name, const char* label, const char* help,
                             double (*value)(const MetricInput&)) {
  return {.name = name,
          .label = label,
          .help = help,
          .value = value,
          .range = kShare,
          .higher_is_better = false,
          .picks = PickCount::multiplicity,
          .matching = Matching::none,
          .reads = Reads::surface_distances};
}

std::vector<Metric> all_metrics() {
  using enum PickCount;
  return {
      {.name = "auc",
       .label = "AUC",
       .help = "area under the ROC curve by the paper's protocol: sampled negatives, 20 thresholds",
       .value = sampled,
       .range = kShare,
       .since = 4},
      {.name = "auc_exact",
       .label = "AUC (exact)",
       .help = "probability that a picked point lies above an unpicked one, ties one half",
       .value = exact,
       .range = kShare},
      {.name = "nss",
       .label = "NSS",
       .unit = kDeviations,
       .help = "mean height of the picks above the mean of the map",
       .value = height_of_picks},
      {.name = "cc",
       .label = "CC",
       .help = "Pearson correlation with the saliency of the ground truth",
       .value = of_saliency<pearson>,
       .range = kCorrelation},
      {.name = "lcc",
       .label = "LCC",
       .help = "magnitude of cc",
       .value = of_saliency<pearson_magnitude>,
       .range = kShare},
      {.name = "auc_judd",
       .label = "AUC (Judd)",
       .help = "area under the ROC curve with thresholds at the picks",
       .value = judd,
       .range = kShare},
      {.name = "auc_borji",
       .label = "AUC (Borji)",
       .help = "area under the ROC curve with sampled negatives and thresholds at every tenth",
       .value = borji,
       .range = kShare,
       .since = 4},
      {.name = "ig",
       .label = "Information gain",
       .unit = kBits,
       .help = "information gain over the uniform map",
       .value = gain,
       .matching = Matching::none},
      {.name = "spearman",
       .label = "Spearman",
       .help = "rank correlation with the saliency of the ground truth",
       .value = of_saliency<pearson_of_ranks>,
       .range = kCorrelation},
      divergence_metric("kl", "KL", "2.2e-16 added to densities", of_saliency<of_divergence<kMitFloors>>),
      divergence_metric("kl_smoothed", "KL (smoothed)", "1e-12 added to values",
                        of_saliency<of_divergence<kSmoothedFloors>>),
      {.name = "sim",
       .label = "SIM",
       .help = "intersection of map and ground truth as distributions",
       .value = of_saliency<intersection>,
       .range = kShare,
       .matching = Matching::none,
       .constant_varies = true},
      {.name = "sim_minmax",
       .label = "SIM (min-max)",
       .help = "the same after min-max normalisation",
       .value = of_saliency<normalised_intersection>,
       .range = kShare,
       .matching = Matching::none,
       .constant_varies = true},
      {.name = "auc_top20",
       .label = "AUC (top 20 %)",
       .help = "auc_exact, positives the upper 20 % of the ground truth",
       .value = of_saliency<of_upper_fifth>,
       .range = kShare},
      {.name = "ig_centre",
       .label = "Information gain (centre bias)",
       .unit = kBits,
       .help = "information gain over the centre bias of the shape, the distance from its centroid",
       .value = gain_over_centre_bias,
       .matching = Matching::none,
       .reads = Reads::positions,
       .constant_varies = true},
      divergence_metric("kl_pysaliency", "KL (pysaliency)", "1e-20 added to values",
                        of_saliency<of_divergence<kPysaliencyFloors>>),
      divergence_metric("kl_shifted", "KL (shifted)", "1e-12 added to both densities",
                        of_saliency<of_divergence<kShiftedFloors>>),
      {.name = "sauc",
       .label = "AUC (shuffled)",
       .help = "as auc_exact, negatives where the other shapes of the set are marked, by the distance from "
               "the centroid",
       .value = shuffled,
       .range = kShare,
       .matching = Matching::none,
       .reads = Reads::other_shapes},
      interest_point_metric("fne", "FNE", "share of the marked points that no local maximum of the map is at",
                            of_interest_points<&InterestPointScores::fne>),
      interest_point_metric("fpe", "FPE", "share of the local maxima of the map that are at no marked point",
                            of_interest_points<&InterestPointScores::fpe>),
      interest_point_metric("wme", "WME", "fne, a marked point as often as it was marked",
                            of_interest_points<&InterestPointScores::wme>),
      {.name = "auc_all",
       .label = "AUC (all points)",
       .help = "as auc_exact, negatives all points; a point as often as it was picked",
       .value = against_all,
       .range = kShare,
       .picks = multiplicity},
      {.name = "nss_multiplicity",
       .label = "NSS, with multiplicity",
       .unit = kDeviations,
       .help = "nss, a point as often as it was picked",
       .value = height_of_picks,
       .picks = multiplicity},
      {.name = "ig_centre_multiplicity",
       .label = "Information gain (centre bias), with multiplicity",
       .unit = kBits,
       .help = "ig_centre, a point as often as it was picked",
       .value = gain_over_centre_bias,
       .picks = multiplicity,
       .matching = Matching::none,
       .reads = Reads::positions,
       .constant_varies = true},
      {.name = "cc_area",
       .label = "CC, by area",
       .help = "cc, points weighed by their area",
       .value = of_saliency<pearson_by_area>,
       .range = kCorrelation,
       .reads = Reads::areas},
  };
}

}  // namespace

std::span<const Metric> metric_table() {
  static const std::vector<Metric> table = all_metrics();
  return table;
}

}  // namespace salbench
