// SPDX-License-Identifier: GPL-3.0-or-later
// The rows are metrics per vertex with each pick counted once; the twins, with multiplicity and by area,
// follow from them. The paper's come first: stored scores and tables have them in this order.
#include <algorithm>
#include <cmath>

#include "stages/core/field.h"
#include "stages/metrics/density.h"
#include "stages/metrics/metrics.h"
#include "stages/metrics/roc.h"

namespace salbench {
namespace {

Splits splits_of(const MetricInput& in) { return {in.options.splits, in.options.thresholds}; }

// The paper's protocol numbers the points, and leaves out the first; by area a number means nothing.
double sampled(const MetricInput& in) {
  RandomValues& negatives = in.weighting == Weighting::vertex
                                ? in.comparison.random_values(in.rng)
                                : in.comparison.random_quantiles(in.weighting, in.rng);
  return sampled_auc(values_at(in.map, in.picked), negatives, splits_of(in));
}

double against_all(const MetricInput& in) { return auc_of_all(in.picked, in.weighting, in.comparison); }

double exact(const MetricInput& in) { return auc_exact(in.picked, in.weighting, in.comparison); }

double judd(const MetricInput& in) { return auc_judd(in.picked, in.weighting, in.comparison); }

double borji(const MetricInput& in) {
  return sampled_auc(values_at(in.map, in.picked), in.comparison.random_quantiles(in.weighting, in.rng),
                     splits_of(in), tenths_of_range(in.comparison.map_distribution(in.weighting)));
}

double height_of_picks(const MetricInput& in) {
  return nss(in.map, in.picked, in.comparison.map_moments(in.weighting), in.options.constant_nss);
}

// A floor is of maps in [0, 1]; others have a unit of their own.
std::span<const double> density_map(const MetricInput& in) {
  return is_normalised(in.matching) ? std::span<const double>(in.comparison.density_map()) : in.map;
}

double gain_over(const MetricInput& in, std::span<const double> baseline, const Density& of_baseline) {
  const std::span<const double> map = density_map(in);
  return information_gain({map, density_of_map(map, in.measure())}, {baseline, of_baseline}, in.picked);
}
double gain(const MetricInput& in) {
  return gain_over(in, in.map, {0, in.measure().unit / in.measure().total});
}
double gain_over_centre_bias(const MetricInput& in) {
  const ScalarField& bias = in.comparison.of.measures.centre_bias;
  return bias.empty() ? kUndefined : gain_over(in, bias, density_of_map(bias, in.measure()));
}

double shuffled(const MetricInput& in) {
  return shuffled_auc(in.map, in.picked, in.comparison.of.measures.negatives, in.measure());
}

// Metrics of the saliency values are undefined without any.
template <double (*value)(const MetricInput&)>
double of_saliency(const MetricInput& in) {
  return in.saliency.empty() ? kUndefined : value(in);
}

template <const DivergenceFloors& floors>
double of_divergence(const MetricInput& in) {
  return divergence(density_map(in), in.comparison.of.raw_saliency, floors, in.measure());
}

double intersection(const MetricInput& in) {
  return similarity(density_map(in), in.comparison.of.raw_saliency, in.measure());
}
double normalised_intersection(const MetricInput& in) {
  return similarity(in.comparison.normalised_density_map(), in.saliency, in.measure());
}

double squared_error(const MetricInput& in) {
  const auto square = [](double difference) { return difference * difference; };
  return mean_error(in.comparison.normalised_map(), in.saliency, square, in.measure());
}
double absolute_error(const MetricInput& in) {
  const auto magnitude = [](double difference) { return std::abs(difference); };
  return mean_error(in.comparison.normalised_map(), in.saliency, magnitude, in.measure());
}

double pearson(const MetricInput& in) { return correlation(in.comparison.with_saliency(in.weighting)); }
double pearson_magnitude(const MetricInput& in) { return std::abs(pearson(in)); }
double cosine_of_fields(const MetricInput& in) {
  return cosine(in.map, in.comparison.of.raw_saliency, in.measure());
}

// cc of the mid-ranks.
double of_ranks(const MetricInput& in) {
  const ScalarField of_saliency = distribution(in.saliency, in.comparison.saliency_order(), in.measure()).mid;
  return correlation(
      pair_moments(in.comparison.map_distribution(in.weighting).mid, of_saliency, in.measure()));
}

TopScore top(const MetricInput& in, int percent) {
  const Comparison& of = in.comparison;
  return top_score({in.map, of.map_distribution(in.weighting), of.map_moments(in.weighting), in.saliency,
                    of.saliency_order()},
                   percent, in.measure());
}
template <int percent>
double top_auc(const MetricInput& in) {
  return top(in, percent).auc;
}
template <int percent>
double top_nss(const MetricInput& in) {
  const TopScore score = top(in, percent);
  const bool constant = !std::isnan(score.auc) && in.comparison.map_moments(in.weighting).constant;
  return constant ? in.options.constant_nss : score.nss;
}

template <double InterestPointScores::*value>
double of_interest_points(const MetricInput& in) {
  const auto& surface = in.comparison.of.measures.surface;
  if (!surface || surface->edges.neighbours.empty()) return kUndefined;
  const LocalMaximaOptions peaks{in.options.peak_radius, in.options.peak_height};
  return in.comparison.interest_points(in.picked, peaks, in.options.tolerance).*value;
}

constexpr Range kAny{}, kShare{0, 1}, kCorrelation{-1, 1}, kDivergence{0};

enum Traits : unsigned {
  kLower = 1,          // is better
  kUnmatched = 2,      // its literature scores maps as models make them
  kVaries = 4,         // the scores of a constant map are not the same for all shapes
  kPicks = 8,          // a row with multiplicity follows
  kMultiplicity = 16,  // with multiplicity alone
  kOnce = 32,          // no row by area
  kOfPositions = 64,   // reads the positions of the points,
  kOfSurface = 128,    // distances along the surface,
  kOfOthers = 256,     // the ground truth of other shapes
  kOfFitted = 512      // a density that is fitted to other shapes
};
// Points are found or not: how many vertices there are, and of which area, does not count.
constexpr unsigned kOfPoints = kUnmatched | kMultiplicity | kOnce | kOfSurface,
                   kDistribution = kUnmatched | kVaries, kLowerDistribution = kDistribution | kLower,
                   kError = kLower | kVaries,
                   kFitted = kOfFitted | kVaries | kMultiplicity | kOnce;  // as it is fitted

struct Row {
  const char *name, *label, *unit, *help;
  double (*value)(const MetricInput&);
  Range range = kAny;
  unsigned traits = 0;
  std::int32_t since = 1;

  bool has(Traits trait) const { return (traits & trait) != 0; }
};

constexpr const char *kDeviations = "standard deviations", *kBits = "bits per pick";
using Found = InterestPointScores;

const Row kRows[] = {
    {"auc", "AUC", "1", "area under the ROC curve by the paper's protocol: sampled negatives, 20 thresholds",
     sampled, kShare, kPicks, 4},
    {"auc_exact", "AUC (exact)", "1",
     "probability that a picked point lies above an unpicked one, ties one half", exact, kShare, kPicks},
    {"nss", "NSS", kDeviations, "mean height of the picks above the mean of the map", height_of_picks, kAny,
     kPicks},
    {"cc", "CC", "1", "Pearson correlation with the saliency of the ground truth", of_saliency<pearson>,
     kCorrelation},
    {"lcc", "LCC", "1", "magnitude of cc", of_saliency<pearson_magnitude>, kShare},
    {"auc_judd", "AUC (Judd)", "1", "area under the ROC curve with thresholds at the picks", judd, kShare,
     kPicks},
    {"auc_borji", "AUC (Borji)", "1",
     "area under the ROC curve with sampled negatives and thresholds at every tenth", borji, kShare, kPicks,
     4},
    {"ig", "Information gain", kBits, "information gain over the uniform map", gain, kAny,
     kPicks | kUnmatched},
    {"spearman", "Spearman", "1", "rank correlation with the saliency of the ground truth",
     of_saliency<of_ranks>, kCorrelation},
    {"kl", "KL", "nats", "Kullback-Leibler divergence from the ground truth, 2.2e-16 added to densities",
     of_saliency<of_divergence<kMitFloors>>, kDivergence, kLowerDistribution},
    {"kl_smoothed", "KL (smoothed)", "nats",
     "Kullback-Leibler divergence from the ground truth, 1e-12 added to values",
     of_saliency<of_divergence<kSmoothedFloors>>, kDivergence, kLowerDistribution},
    {"sim", "SIM", "1", "intersection of map and ground truth as distributions", of_saliency<intersection>,
     kShare, kDistribution},
    {"sim_minmax", "SIM (min-max)", "1", "the same after min-max normalisation",
     of_saliency<normalised_intersection>, kShare, kDistribution},
    {"mse", "MSE", "1", "mean squared difference after min-max normalisation", of_saliency<squared_error>,
     kShare, kError, 2},
    {"mae", "MAE", "1", "mean absolute difference after min-max normalisation", of_saliency<absolute_error>,
     kShare, kError, 2},
    {"auc_top20", "AUC (top 20 %)", "1", "auc_exact, positives the upper 20 % of the ground truth",
     of_saliency<top_auc<20>>, kShare},
    {"auc_top10", "AUC (top 10 %)", "1", "auc_exact, positives the upper 10 % of the ground truth",
     of_saliency<top_auc<10>>, kShare},
    {"auc_top5", "AUC (top 5 %)", "1", "auc_exact, positives the upper 5 % of the ground truth",
     of_saliency<top_auc<5>>, kShare},
    {"auc_top1", "AUC (top 1 %)", "1", "auc_exact, positives the upper 1 % of the ground truth",
     of_saliency<top_auc<1>>, kShare},
    {"nss_top20", "NSS (top 20 %)", kDeviations, "mean height of the upper 20 % of the ground truth",
     of_saliency<top_nss<20>>},
    {"nss_top10", "NSS (top 10 %)", kDeviations, "mean height of the upper 10 % of the ground truth",
     of_saliency<top_nss<10>>},
    {"nss_top5", "NSS (top 5 %)", kDeviations, "mean height of the upper 5 % of the ground truth",
     of_saliency<top_nss<5>>},
    {"nss_top1", "NSS (top 1 %)", kDeviations, "mean height of the upper 1 % of the ground truth",
     of_saliency<top_nss<1>>},
    {"ig_centre", "Information gain (centre bias)", kBits,
     "information gain over the centre bias of the shape, the distance from its centroid",
     gain_over_centre_bias, kAny, kPicks | kDistribution | kOfPositions},
    // What came after the first release.
    {"cosine", "Cosine", "1", "cosine of the angle between map and ground truth as they are",
     of_saliency<cosine_of_fields>, kCorrelation, kDistribution},
    {"kl_keras", "KL (Keras)", "nats",
     "Kullback-Leibler divergence from the ground truth, 1e-7 added to densities",
     of_saliency<of_divergence<kKerasFloors>>, kDivergence, kLowerDistribution},
    {"kl_caffe", "KL (Caffe)", "nats",
     "Kullback-Leibler divergence from the ground truth, 1e-6 added to densities",
     of_saliency<of_divergence<kCaffeFloors>>, kDivergence, kLowerDistribution},
    {"kl_pysaliency", "KL (pysaliency)", "nats",
     "Kullback-Leibler divergence from the ground truth, 1e-20 added to values",
     of_saliency<of_divergence<kPysaliencyFloors>>, kDivergence, kLowerDistribution},
    {"kl_shifted", "KL (shifted)", "nats",
     "Kullback-Leibler divergence from the ground truth, 1e-12 added to both densities",
     of_saliency<of_divergence<kShiftedFloors>>, kDivergence, kLowerDistribution},
    {"sauc", "AUC (shuffled)", "1",
     "as auc_exact, negatives where the other shapes of the set are marked, by the distance from the "
     "centroid",
     shuffled, kShare, kPicks | kUnmatched | kOfOthers},
    {"fne", "FNE", "1", "share of the marked points that no local maximum of the map is at",
     of_interest_points<&Found::fne>, kShare, kOfPoints | kLower},
    {"fpe", "FPE", "1", "share of the local maxima of the map that are at no marked point",
     of_interest_points<&Found::fpe>, kShare, kOfPoints | kLower},
    {"wme", "WME", "1", "fne, a marked point as often as it was marked", of_interest_points<&Found::wme>,
     kShare, kOfPoints | kLower},
    {"precision", "Precision", "1", "share of the local maxima of the map with a marked point nearby",
     of_interest_points<&Found::precision>, kShare, kOfPoints},
    {"recall", "Recall", "1", "share of the marked points with a local maximum of the map nearby",
     of_interest_points<&Found::recall>, kShare, kOfPoints},
    {"auc_all", "AUC (all points)", "1",
     "as auc_exact, negatives all points; a point as often as it was picked", against_all, kShare,
     kMultiplicity | kOnce},
    {"ig_fitted", "Information gain (fitted)", kBits,
     "ig of the density that is fitted to other shapes of the set", gain, kAny, kFitted},
    {"kl_fitted", "KL (fitted)", "nats", "kl of the density that is fitted to other shapes of the set",
     of_saliency<of_divergence<kMitFloors>>, kDivergence, kFitted | kLower},
    {"sim_fitted", "SIM (fitted)", "1", "sim of the density that is fitted to other shapes of the set",
     of_saliency<intersection>, kShare, kFitted},
};

Metric metric_of(const Row& row) {
  Metric metric{row.name, row.label, row.unit, row.help, row.value, row.range, row.since};
  metric.higher_is_better = !row.has(kLower);
  if (row.has(kMultiplicity)) metric.picks = PickCount::multiplicity;
  if (row.has(kUnmatched)) metric.matching = Matching::none;
  if (row.has(kOfFitted)) metric.matching = Matching::fitted;
  metric.reads_positions = row.has(kOfPositions);
  metric.reads_surface = row.has(kOfSurface);
  metric.reads_others = row.has(kOfOthers);
  metric.constant_varies = row.has(kVaries);
  return metric;
}

std::vector<Metric> all_metrics() {
  std::vector<Metric> table, by_area;
  const auto add = [&](const Metric& metric, const Row& row) {
    table.push_back(metric);
    if (row.has(kOnce)) return;
    Metric& twin = by_area.emplace_back(metric);
    twin.help = twin.name + ", points weighed by their area";
    twin.name += "_area";
    twin.label += ", by area";
    twin.weighting = Weighting::area;
  };
  for (const Row& row : kRows) add(metric_of(row), row);
  for (const Row& row : kRows) {
    if (!row.has(kPicks)) continue;
    Metric twin = metric_of(row);
    twin.help = twin.name + ", a point as often as it was picked";
    twin.name += "_multiplicity";
    twin.label += ", with multiplicity";
    twin.picks = PickCount::multiplicity;
    add(twin, row);
  }
  table.insert(table.end(), by_area.begin(), by_area.end());
  return table;
}

}  // namespace

std::span<const Metric> metric_table() {
  static const std::vector<Metric> table = all_metrics();
  return table;
}

}  // namespace salbench
