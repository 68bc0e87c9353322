// SPDX-License-Identifier: GPL-3.0-or-later
// Options of the metrics: names, and the form in which they read maps.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "stages/core/options.h"

namespace salbench {

// Form in which a metric reads a map.
enum class Matching : std::uint8_t {
  none,       // min-max-normalised
  histogram,  // its histogram is matched
  raw,        // as the model computed it; must not be below 0
  shifted     // the same, minus its least value if that is below 0
};
template <>
struct EnumNames<Matching> {
  static constexpr std::array<std::string_view, 4> names{"none", "histogram", "raw", "shifted"};
};

// True if maps are in [0, 1] in this form.
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

}  // namespace salbench
