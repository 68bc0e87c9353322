// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/by_matching.h"

#include "stages/metrics/measure.h"

namespace salbench {

MetricsByMatching::MetricsByMatching(const MetricsOptions& options) : all_(chosen_metrics(options)) {
  for (std::size_t m = 0; m < all_.size(); ++m) {
    Part& part = parts_[static_cast<std::size_t>(all_[m].matching)];
    part.metrics.push_back(all_[m]);
    part.places.push_back(m);
  }
}

Scores MetricsByMatching::score(const ScorePart& score_part) const {
  Scores scores{std::vector<double>(all_.size(), kUndefined)};
  for (const Matching matching : {Matching::histogram, Matching::none, Matching::raw, Matching::shifted}) {
    if (!any(matching)) continue;
    const Scores of_part = score_part(part(matching).metrics, matching);
    for (std::size_t m = 0; m < of_part.values.size(); ++m)
      scores.values[part(matching).places[m]] = of_part.values[m];
    scores.n_points = of_part.n_points;
    scores.n_picks = of_part.n_picks;
  }
  return scores;
}

}  // namespace salbench
