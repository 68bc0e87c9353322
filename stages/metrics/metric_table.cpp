// SPDX-License-Identifier: GPL-3.0-or-later
// The rows are metrics per vertex with each pick counted once; the twins, with multiplicity and by area,
// follow from them. The paper's come first: stored scores and tables have them in this order.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <string_view>
#include <tuple>
#include <utility>

#include "stages/core/field.h"
#include "stages/metrics/density.h"
#include "stages/metrics/metrics.h"
#include "stages/metrics/roc.h"
#include "stages/metrics/sampled_roc.h"
#include "stages/metrics/shuffled_roc.h"
#include "stages/metrics/top.h"

namespace salbench {
namespace {

Splits splits_of(const MetricInput& in) { return {in.options.splits, in.options.thresholds}; }

// The paper's protocol numbers the points, and leaves out the first; by area a number means nothing.
double sampled(const MetricInput& in) {
  const ScalarField picks = values_at(in.map, in.picked);
  if (in.weighting == Weighting::vertex) return sampled_auc(in.map, picks, splits_of(in), in.rng);
  return quantile_auc(in.comparison.map_distribution(Weighting::area), picks, Thresholds::even, splits_of(in),
                      in.rng);
}

double against_all(const MetricInput& in) { return auc_of_all(in.picked, in.weighting, in.comparison); }

double exact(const MetricInput& in) { return auc_exact(in.picked, in.weighting, in.comparison); }

double judd(const MetricInput& in) { return auc_judd(in.picked, in.weighting, in.comparison); }

double borji(const MetricInput& in) {
  return quantile_auc(in.comparison.map_distribution(in.weighting), values_at(in.map, in.picked),
                      Thresholds::tenths, splits_of(in), in.rng);
}

double height_of_picks(const MetricInput& in) {
  return nss(in.map, in.picked, in.comparison.map_moments(in.weighting), in.options.constant_nss);
}

double gain_over(const MetricInput& in, std::span<const double> baseline, const Density& of_baseline) {
  const ScalarField& map = in.comparison.density_map();
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
  return divergence(in.comparison.density_map(), in.comparison.of.raw_saliency, floors, in.measure());
}

double intersection(const MetricInput& in) {
  return similarity(in.comparison.density_map(), in.comparison.of.raw_saliency, in.measure());
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

struct BaseMetric {
  Metric metric;
  bool of_picks = false;   // picks have a multiplicity
  bool of_measure = true;  // points have a weight
};

constexpr Range kShare{0, 1}, kCorrelation{-1, 1}, kDivergence{0};

// Its literature scores maps as models make them.
BaseMetric unmatched(BaseMetric row) {
  row.metric.matching = Matching::none;
  return row;
}

// The scores of a constant map are not the same for all shapes.
BaseMetric varying(BaseMetric row) {
  row.metric.constant_varies = true;
  return row;
}

// The same of a fitted density, per vertex and pick, as it is fitted.
BaseMetric fitted(const BaseMetric& row, const char* name, const char* label) {
  Metric metric = row.metric;
  metric.help = metric.name + " of the density that is fitted to other shapes of the set";
  metric.name = name;
  metric.label = label;
  metric.matching = Matching::fitted;
  metric.constant_varies = true;
  metric.picks = PickCount::multiplicity;
  return {std::move(metric), false, false};
}

// Points are found or not: how many vertices there are, and of which area, does not count.
BaseMetric of_points(Metric metric, bool higher_is_better) {
  metric.higher_is_better = higher_is_better;
  metric.range = kShare;
  metric.picks = PickCount::multiplicity;
  metric.matching = Matching::none;
  metric.reads_surface = true;
  return {std::move(metric), false, false};
}

constexpr const char* kDeviations = "standard deviations";

BaseMetric divergence_row(const char* name, const char* label, const char* what,
                          double (*value)(const MetricInput&)) {
  return varying(unmatched(
      {{name, label, "nats", std::string("Kullback-Leibler divergence from the ground truth, ") + what, value,
        kDivergence, 1, false}}));
}

// What came after the first release.
std::vector<BaseMetric> later_metrics() {
  using Points = InterestPointScores;
  BaseMetric against_others = unmatched(
      {{"sauc", "AUC (shuffled)", "1",
        "as auc_exact, negatives where the other shapes of the set are marked, by the distance from "
        "the centroid",
        shuffled, kShare},
       true});
  against_others.metric.reads_others = true;
  BaseMetric of_all{
      {"auc_all", "AUC (all points)", "1",
       "as auc_exact, negatives all points; a point as often as it was picked", against_all, kShare},
      false,
      false};
  of_all.metric.picks = PickCount::multiplicity;
  return {
      varying(
          unmatched({{"cosine", "Cosine", "1", "cosine of the angle between map and ground truth as they are",
                      of_saliency<cosine_of_fields>, kCorrelation}})),
      divergence_row("kl_keras", "KL (Keras)", "1e-7 added to densities",
                     of_saliency<of_divergence<kKerasFloors>>),
      divergence_row("kl_caffe", "KL (Caffe)", "1e-6 added to densities",
                     of_saliency<of_divergence<kCaffeFloors>>),
      divergence_row("kl_pysaliency", "KL (pysaliency)", "1e-20 added to values",
                     of_saliency<of_divergence<kPysaliencyFloors>>),
      divergence_row("kl_shifted", "KL (shifted)", "1e-12 added to both densities",
                     of_saliency<of_divergence<kShiftedFloors>>),
      against_others,
      of_points({"fne", "FNE", "1", "share of the marked points that no local maximum of the map is at",
                 of_interest_points<&Points::fne>},
                false),
      of_points({"fpe", "FPE", "1", "share of the local maxima of the map that are at no marked point",
                 of_interest_points<&Points::fpe>},
                false),
      of_points({"wme", "WME", "1", "fne, a marked point as often as it was marked",
                 of_interest_points<&Points::wme>},
                false),
      of_points(
          {"precision", "Precision", "1", "share of the local maxima of the map with a marked point nearby",
           of_interest_points<&Points::precision>},
          true),
      of_points({"recall", "Recall", "1", "share of the marked points with a local maximum of the map nearby",
                 of_interest_points<&Points::recall>},
                true),
      of_all,
  };
}

std::vector<BaseMetric> base_metrics() {
  std::vector<BaseMetric> rows = {
      {{"auc", "AUC", "1",
        "area under the ROC curve by the paper's protocol: sampled negatives, 20 thresholds", sampled, kShare,
        4},
       true},
      {{"auc_exact", "AUC (exact)", "1",
        "probability that a picked point lies above an unpicked one, ties one half", exact, kShare},
       true},
      {{"nss", "NSS", kDeviations, "mean height of the picks above the mean of the map", height_of_picks},
       true},
      {{"cc", "CC", "1", "Pearson correlation with the saliency of the ground truth", of_saliency<pearson>,
        kCorrelation}},
      {{"lcc", "LCC", "1", "magnitude of cc", of_saliency<pearson_magnitude>, kShare}},
      {{"auc_judd", "AUC (Judd)", "1", "area under the ROC curve with thresholds at the picks", judd, kShare},
       true},
      {{"auc_borji", "AUC (Borji)", "1",
        "area under the ROC curve with sampled negatives and thresholds at every tenth", borji, kShare, 4},
       true},
      unmatched(
          {{"ig", "Information gain", "bits per pick", "information gain over the uniform map", gain}, true}),
      {{"spearman", "Spearman", "1", "rank correlation with the saliency of the ground truth",
        of_saliency<of_ranks>, kCorrelation}},
      varying(unmatched({{"kl", "KL", "nats",
                          "Kullback-Leibler divergence from the ground truth, 2.2e-16 added to densities",
                          of_saliency<of_divergence<kMitFloors>>, kDivergence, 1, false}})),
      varying(unmatched({{"kl_smoothed", "KL (smoothed)", "nats",
                          "Kullback-Leibler divergence from the ground truth, 1e-12 added to values",
                          of_saliency<of_divergence<kSmoothedFloors>>, kDivergence, 1, false}})),
      varying(unmatched({{"sim", "SIM", "1", "intersection of map and ground truth as distributions",
                          of_saliency<intersection>, kShare}})),
      varying(unmatched({{"sim_minmax", "SIM (min-max)", "1", "the same after min-max normalisation",
                          of_saliency<normalised_intersection>, kShare}})),
      varying({{"mse", "MSE", "1", "mean squared difference after min-max normalisation",
                of_saliency<squared_error>, kShare, 2, false}}),
      varying({{"mae", "MAE", "1", "mean absolute difference after min-max normalisation",
                of_saliency<absolute_error>, kShare, 2, false}}),
  };
  const auto add_top = [&]<int... percent>(std::integer_sequence<int, percent...>) {
    const auto of = [](const char* before, int part, const char* after) {
      return before + std::to_string(part) + after;
    };
    (rows.push_back({{of("auc_top", percent, ""), of("AUC (top ", percent, " %)"), "1",
                      of("auc_exact, positives the upper ", percent, " % of the ground truth"),
                      of_saliency<top_auc<percent>>, kShare}}),
     ...);
    (rows.push_back({{of("nss_top", percent, ""), of("NSS (top ", percent, " %)"), kDeviations,
                      of("mean height of the upper ", percent, " % of the ground truth"),
                      of_saliency<top_nss<percent>>}}),
     ...);
  };
  add_top(std::integer_sequence<int, 20, 10, 5, 1>());
  BaseMetric over_centre_bias = varying(
      unmatched({{"ig_centre", "Information gain (centre bias)", "bits per pick",
                  "information gain over the centre bias of the shape, the distance from its centroid",
                  gain_over_centre_bias},
                 true}));
  over_centre_bias.metric.reads_positions = true;
  rows.push_back(over_centre_bias);
  std::ranges::move(later_metrics(), std::back_inserter(rows));
  const auto of = [&](std::string_view name) {
    return *std::ranges::find(rows, name,
                              [](const BaseMetric& row) -> std::string_view { return row.metric.name; });
  };
  for (const auto& [name, plain, label] : {std::tuple("ig_fitted", "ig", "Information gain (fitted)"),
                                           {"kl_fitted", "kl", "KL (fitted)"},
                                           {"sim_fitted", "sim", "SIM (fitted)"}})
    rows.push_back(fitted(of(plain), name, label));
  return rows;
}

std::vector<Metric> all_metrics() {
  std::vector<Metric> table;
  const std::vector<BaseMetric> base = base_metrics();
  for (const BaseMetric& row : base) table.push_back(row.metric);
  for (const BaseMetric& row : base) {
    if (!row.of_picks) continue;
    Metric& twin = table.emplace_back(row.metric);
    twin.help = twin.name + ", a point as often as it was picked";
    twin.name += "_multiplicity";
    twin.label += ", with multiplicity";
    twin.picks = PickCount::multiplicity;
  }
  for (std::size_t row = 0, per_vertex = table.size(); row < per_vertex; ++row) {
    if (row < base.size() && !base[row].of_measure) continue;
    Metric twin = table[row];
    twin.help = twin.name + ", points weighed by their area";
    twin.name += "_area";
    twin.label += ", by area";
    twin.weighting = Weighting::area;
    table.push_back(std::move(twin));
  }
  return table;
}

}  // namespace

std::span<const Metric> metric_table() {
  static const std::vector<Metric> table = all_metrics();
  return table;
}

}  // namespace salbench
