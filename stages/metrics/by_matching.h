// SPDX-License-Identifier: GPL-3.0-or-later
// The metrics named in the options, grouped by the form in which they read maps: each group is scored on its
// own form, and the scores are combined in the order of the table.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "stages/core/types.h"
#include "stages/metrics/metrics.h"

namespace salbench {

class MetricsByMatching {
 public:
  explicit MetricsByMatching(const MetricsOptions& options);

  const std::vector<Metric>& all() const { return all_; }
  bool any(Matching matching) const { return !part(matching).metrics.empty(); }
  bool any_unmatched() const { return part(Matching::histogram).metrics.size() < all_.size(); }

  // Calls `score_part` for each matching used by a metric.
  using ScorePart = std::function<Scores(std::span<const Metric> metrics, Matching matching)>;
  Scores score(const ScorePart& score_part) const;

 private:
  struct Part {
    std::vector<Metric> metrics;
    std::vector<std::size_t> places;  // indices into all_
  };
  const Part& part(Matching matching) const { return parts_[static_cast<std::size_t>(matching)]; }

  std::vector<Metric> all_;
  std::array<Part, EnumNames<Matching>::names.size()> parts_;
};

}  // namespace salbench
