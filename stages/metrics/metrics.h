// SPDX-License-Identifier: GPL-3.0-or-later
// Agreement of a saliency map with what people marked. `map` has one finite value per point, as the metric
// reads it (Matching); `picked` are point indices, ascending. [tasse2016]
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "stages/core/options.h"
#include "stages/core/rng.h"
#include "stages/core/types.h"
#include "stages/metrics/comparison.h"
#include "stages/metrics/roc.h"

namespace salbench {

// Form in which a metric reads a map.
enum class Matching : std::uint8_t {
  none,       // min-max-normalised
  histogram,  // its histogram is matched
  raw,        // as the model made it, which must not be below 0
  shifted,    // the same; where it has values below 0, its least value is subtracted
  fitted      // as a density that is fitted to other shapes of the set
};
template <>
struct EnumNames<Matching> {
  static constexpr std::array<std::string_view, 5> names{"none", "histogram", "raw", "shifted", "fitted"};
};

// Whether maps are in [0, 1] in this form.
constexpr bool is_normalised(Matching form) { return form == Matching::none || form == Matching::histogram; }

struct MetricsOptions {
  std::int32_t splits = 100;
  std::int32_t thresholds = 20;
  double constant_nss = 0;
  std::vector<std::string> names = {"auc", "auc_exact", "nss", "cc", "lcc"};
  ByName<Matching> matching = {};
  double floor = 0;
  double peak_radius = 0;
  double peak_height = 1;
  double tolerance = 0.03;
  std::vector<std::string> smoothing = {};

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("splits", self.splits,
          {"random draws of unpicked points that the AUC is averaged over", "draws", at_least(1)});
    visit("thresholds", self.thresholds,
          {"points of the ROC curve, evenly spaced over the values", "points", at_least(2)});
    visit("constant_nss", self.constant_nss, {"NSS of a constant map", "standard deviations", {}, "0"});
    visit("names", self.names,
          {"metrics, or all: docs/metrics.md has a table of them", "", {}, "[auc, auc_exact, nss, cc, lcc]"});
    visit("matching", self.matching,
          {"reading of the maps, for all metrics or by name; else as in docs/metrics.md", "", {}, "{}"});
    visit("floor", self.floor,
          {"least value of maps in [0, 1] that are read as densities", "", between(0, 1), "0"});
    visit("peak_radius", self.peak_radius,
          {"neighbourhood of interest points, the local maxima of a map; 0: the points next to them", "R",
           at_least(0), "0"});
    visit("peak_height", self.peak_height,
          {"least height of interest points", "mean height of the local maxima", at_least(0), "1"});
    visit("tolerance", self.tolerance,
          {"distance at which an interest point is found", "diameter", above(0), "0.03"});
    visit("smoothing", self.smoothing,
          {"scores of smoothed maps beside the others: numbers of steps, such as [0, 10, 40, 120]",
           "",
           {},
           "[]"});
  }
};

void check(const MetricsOptions& options);  // throws OptionError

std::vector<std::int32_t> smoothing_steps(const MetricsOptions& options);  // throws OptionError

// Mean over the picks of how many (population) standard deviations the map lies above its mean; `constant`
// for a constant map, NaN without picks. [peters2005]
double nss(std::span<const double> map, std::span<const std::int32_t> picked, double constant = 0);
double nss(std::span<const double> map, std::span<const std::int32_t> picked, const Moments& of_map,
           double constant);

// Pearson correlation; 0 where one of the two is constant, NaN for empty fields. [tasse2016]
double cc(std::span<const double> map, std::span<const double> saliency);

// Weight of a point that several participants picked, or one of them repeatedly.
enum class PickCount : std::uint8_t { once, multiplicity };

// Inputs of a metric.
struct MetricInput {
  std::span<const double> map;           // n
  std::span<const std::int32_t> picked;  // ascending; each once, or as often as it was picked
  std::span<const double> saliency;      // n, min-max-normalised; empty where not known
  const MetricsOptions& options;
  Rng rng;  // a metric draws from its own copy, so all metrics see the same stream
  Weighting weighting;
  Matching matching;             // form of the map
  const Comparison& comparison;  // of map and saliency

  const Measure& measure() const { return comparison.measure(weighting); }
};

struct Metric {
  std::string name;   // column of results.csv
  std::string label;  // the same for people
  std::string unit;
  std::string help;
  double (*value)(const MetricInput&);  // NaN where undefined
  Range range = {};                     // what the value can be at all
  std::int32_t since = 1;               // version of the stage `scores` with which these values came
  bool higher_is_better = true;
  Weighting weighting = Weighting::vertex;
  PickCount picks = PickCount::once;
  Matching matching = Matching::histogram;  // unless the options say otherwise
  bool reads_positions = false;             // of the points
  bool reads_surface = false;               // distances along it
  bool reads_others = false;                // ground truth of the other shapes of the set
  bool constant_varies = false;             // the score of a constant map differs from shape to shape
};

// The table of metrics: a new one is a function and a row at the end of its part. A metric whose values
// change takes the next number in the table as its `since`; a new one starts at 1, since keys name the
// metrics chosen.
std::span<const Metric> metric_table();

// Those that the options name, with the matching that these choose, in the order of the table. Throws
// OptionError for a name that is not in it.
std::vector<Metric> chosen_metrics(const MetricsOptions& options);

// The map as metrics read it where no histogram is matched: min-max-normalised, unless the reading is raw or
// shifted, or the map is fitted already. NaN counts as 0. Throws InputError for a value below 0 that is read
// raw, and for an infinite one.
ScalarField unmatched(std::span<const double> map, Matching reading);

// Version of the stage `scores` for these metrics: the largest `since`, and at least 3 where one of them
// reads maps without matching. With a floor, those that read maps as they are made have 5 as their `since`:
// they had the floor once, which is of maps in [0, 1].
std::int32_t scores_version(std::span<const Metric> metrics);

bool any_by_area(std::span<const Metric> metrics);  // they read the areas of the points
bool any_of_positions(std::span<const Metric> metrics);
bool any_of_others(std::span<const Metric> metrics);
bool any_of_points(std::span<const Metric> metrics);  // they read where the points are
bool any_of_faces(std::span<const Metric> metrics);

// What these metrics read of a shape of n points. None of it is needed if they read none: `points` and
// `surface` may be empty then. `negatives` are the weights of the points as negatives of sauc.
Measures measures_of(std::span<const Metric> metrics, std::size_t n, Points points, Surface surface,
                     ScalarField negatives = {});

// The metrics of one map, in their order. What the ground truth has nothing for is NaN: metrics of picks
// without picks, metrics of saliency without saliency values, metrics by area without areas, and those of the
// centre bias, of the surface or of other shapes where it is not known. Points
// whose saliency is NaN, which nobody saw, take no part: neither their values nor picks there. A constant map
// counts as 0.5 everywhere, whichever constant it is. Throws InputError where the ground truth is not of this
// shape: picks out of range, or another number of points; and for other values that are not finite.
// Every metric reads the random numbers from their beginning.
Scores score(std::span<const Metric> metrics, std::span<const double> map, const GroundTruth& truth,
             const MetricsOptions& options, const Rng& rng, const Measures& measures);
Scores score(std::span<const Metric> metrics, const ScalarField& map, const GroundTruth& truth,
             const MetricsOptions& options, const Rng& rng, std::span<const double> areas = {},
             std::span<const double> centre_bias = {});
// Those that the options name.
Scores score(const ScalarField& map, const GroundTruth& truth, const MetricsOptions& options, Rng rng,
             std::span<const double> areas = {});

// Rounding can put a value beyond what it can be, such as a correlation of 1 + 2e-16. Stored scores keep it;
// what is shown does not.
Scores in_range(std::span<const Metric> metrics, Scores scores);

// Score of a constant map; nothing where it differs from shape to shape.
std::optional<double> score_of_constant(const Metric& metric, const MetricsOptions& options);

// The metrics chosen, apart by their matching. Each part is scored on its own, and the scores are put
// together in the order of the table.
class MetricsByMatching {
 public:
  explicit MetricsByMatching(const MetricsOptions& options);

  const std::vector<Metric>& all() const { return all_; }
  bool any(Matching matching) const { return !part(matching).metrics.empty(); }
  bool any_unmatched() const { return part(Matching::histogram).metrics.size() < all_.size(); }

  // Calls `score_part` for each matching that any metric has. Without values, these metrics are undefined.
  using ScorePart = std::function<Scores(std::span<const Metric> metrics, Matching matching)>;
  Scores score(const ScorePart& score_part) const;

 private:
  struct Part {
    std::vector<Metric> metrics;
    std::vector<std::size_t> places;  // in all_
  };
  const Part& part(Matching matching) const { return parts_[static_cast<std::size_t>(matching)]; }

  std::vector<Metric> all_;
  std::array<Part, EnumNames<Matching>::names.size()> parts_;
};

// Value of one metric of those that the options name. Throws std::out_of_range for another one.
double value_of(const Scores& scores, std::string_view metric, const MetricsOptions& options = {});

}  // namespace salbench
