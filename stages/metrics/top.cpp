// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/top.h"

#include <cstddef>
#include <limits>

namespace salbench {
namespace {

// Sums over the points of highest saliency, from the top down.
class TopSums {
 public:
  TopSums(const TopInput& in, const Measure& measure)
      : in_(in), measure_(measure), next_(in.saliency_order.size()) {
    while (!(measure.weight[in.saliency_order[above_]] > 0)) ++above_;
    const double minimum = value(above_);
    while (value(above_) <= minimum) ++above_;
  }

  bool at_minimum() const { return next_ == above_; }
  double weight() const { return weight_; }

  // Equal values come together.
  void add_next_value() {
    const double shared = value(next_ - 1);
    do {
      const std::size_t i = in_.saliency_order[--next_];
      weight_ += measure_.weight[i];
      mid_ += measure_.weight[i] * in_.map_distribution.mid[i];
      height_ += measure_.weight[i] * (in_.map[i] - in_.map_moments.mean);
    } while (!at_minimum() && value(next_ - 1) == shared);
  }

  // Over all points, of which weight^2 / 2 falls to pairs on top: each has one win, and each point a tie with
  // itself.
  double auc() const { return (mid_ - weight_ * weight_ / 2) / (weight_ * (measure_.total - weight_)); }
  double nss() const { return height_ / (weight_ * in_.map_moments.deviation); }

 private:
  double value(std::size_t k) const { return in_.saliency[in_.saliency_order[k]]; }

  const TopInput& in_;
  const Measure& measure_;
  std::size_t next_;       // points of the order from here on are summed
  std::size_t above_ = 0;  // and from here on lie above the minimum of those that have a weight
  double weight_ = 0, mid_ = 0, height_ = 0;
};

}  // namespace

TopScores top_scores(const TopInput& in, const Measure& measure) {
  TopScores scores;
  scores.auc.fill(std::numeric_limits<double>::quiet_NaN());
  scores.nss = scores.auc;
  if (is_constant(in.saliency, measure)) return scores;
  TopSums sums(in, measure);
  for (std::size_t k = kTopPercents.size(); k-- > 0;) {
    // Sums of areas are rounded: equal parts must not differ by that.
    const double part = kTopPercents[k] / 100.0 * measure.total * (1 - 1e-9);
    while (!sums.at_minimum() && sums.weight() < part) sums.add_next_value();
    scores.auc[k] = sums.auc();
    scores.nss[k] = sums.nss();
  }
  return scores;
}

}  // namespace salbench
