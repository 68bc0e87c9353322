// Agreement of a saliency map with what people marked. `map` is a histogram-matched map with one finite value
// per point; `picked` are distinct point indices, picked by at least one participant. [tasse2016]
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "stages/core/options.h"
#include "stages/core/rng.h"
#include "stages/core/types.h"

namespace salbench {

struct MetricsOptions {
  std::int32_t splits = 100;
  std::int32_t thresholds = 20;
  double constant_nss = 0;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("splits", self.splits,
          {"random draws of unpicked points that the AUC is averaged over", "draws", at_least(1)});
    visit("thresholds", self.thresholds,
          {"points of the ROC curve, evenly spaced over the values", "points", at_least(2)});
    visit("constant_nss", self.constant_nss, {"NSS of a constant map", "standard deviations", {}, "0"});
  }
};

// Area under the ROC curve by the paper's protocol: as many negatives as there are picks are drawn with
// replacement from all points but the first, once per split. NaN without picks or with a single point.
// [tasse2016]
double auc(std::span<const double> map, std::span<const std::int32_t> picked, const MetricsOptions& options,
           Rng rng);

// Probability that a picked point has a larger value than an unpicked one, ties one half: the AUC without
// sampling and without thresholds. O(n log n). NaN where all points or none are picked. [mann1947]
double auc_exact(std::span<const double> map, std::span<const std::int32_t> picked);

// Mean over the picks of how many (population) standard deviations the map lies above its mean; `constant`
// for a constant map, NaN without picks. [tasse2016]
double nss(std::span<const double> map, std::span<const std::int32_t> picked, double constant = 0);

// Pearson correlation; 0 where one of the two is constant, NaN for empty fields. [tasse2016]
double cc(std::span<const double> map, std::span<const double> saliency);

// What a metric may read.
struct MetricInput {
  std::span<const double> map;           // n
  std::span<const std::int32_t> picked;  // ascending
  std::span<const double> saliency;      // n, min-max-normalised; empty where not known
  const MetricsOptions& options;
  Rng rng;  // a metric draws from its own copy, so all metrics see the same stream
};

struct Metric {
  std::string_view name;  // column of results.csv
  std::string_view unit;
  std::string_view help;
  double (*value)(const MetricInput&);  // NaN where undefined
  std::int32_t since = 1;               // version of the stage `scores` with which these values came
};

// The table of metrics: a new one is a function and a row at the end. Stored scores hold one value per row,
// in this order. A new row, or one whose values change, takes the next number as its `since`.
std::span<const Metric> metric_table();

// Version of the stage `scores`: the largest `since` of the table.
std::int32_t scores_version();

// All metrics of one map, those of `metrics` or of the table. What the ground truth has nothing for is NaN:
// auc, auc_exact and nss without picks, cc and lcc without saliency values. Throws InputError where the
// ground truth is not of this shape: picks out of range, or another number of points.
Scores score(std::span<const Metric> metrics, const ScalarField& matched, const GroundTruth& truth,
             const MetricsOptions& options, Rng rng);
Scores score(const ScalarField& matched, const GroundTruth& truth, const MetricsOptions& options, Rng rng);

// Value of one metric of the table. Throws std::out_of_range for a name that is not in it.
double value_of(const Scores& scores, std::string_view metric);

}  // namespace salbench
