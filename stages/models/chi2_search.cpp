// SPDX-License-Identifier: GPL-3.0-or-later
// Histograms that resemble each other are put in groups of 16, groups in groups of 16 and so on, each with
// the box that holds it. A query guesses the distance of its k-th nearest from the query before, which
// resembles it; what lies in a box farther away than the guess is not looked at. If the k-th nearest lies
// within the guess, nothing was missed; otherwise the guess is raised.
#include "stages/models/chi2_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "stages/core/check.h"
#include "stages/core/errors.h"
#include "stages/core/parallel.h"
#include "stages/models/chi2_grouping.h"
#include "stages/models/chi_square.h"

namespace salbench {
namespace {

using chi2_kernel::groups_of;
using chi2_kernel::kLanes;

constexpr std::size_t kBins = kFpfhBins;
constexpr float kMaxValue = 1e18F;  // the squares of larger values overflow
constexpr float kInfinity = std::numeric_limits<float>::infinity();
// A bound is computed like a distance, from fewer than 40 rounded terms: it may exceed the distance by
// rounding.
constexpr float kRounding = 1 + 1e-5F;
constexpr float kGuess = 1.06F;       // times the k-th distance of the query before
constexpr float kAlike = 1e-9F;       // of the largest distance: within, histograms do not differ
constexpr std::size_t kSpare = 8;     // so few candidates beyond the k-th are put in order, not counted again
constexpr std::size_t kGrain = 1024;  // queries one after the other; the first of them guesses nothing
constexpr float kOpened = std::numeric_limits<float>::quiet_NaN();  // in place of a bound: within no limit

// At least one.
std::vector<std::size_t> bins_of(const Descriptors& descriptors) {
  for (std::size_t i = 0; i < descriptors.values.size(); ++i)
    if (const float value = descriptors.values[i]; !(value >= 0 && value <= kMaxValue))
      throw InputError("the descriptor of point " + std::to_string(i / kBins) + " (0-based) has the value " +
                       std::to_string(value) + ", expected a number from 0 to 1e18");
  std::vector<std::size_t> bins = used_bins(descriptors);
  if (bins.empty()) bins.push_back(0);
  return bins;
}

// More than any distance: no (a - b)^2 / (a + b) is above a + b.
float beyond_all(const Descriptors& descriptors) {
  float largest = 0;
  for (std::size_t i = 0; i < descriptors.size(); ++i) {
    const auto row = descriptors.row(i);
    largest = std::max(largest, std::accumulate(row.begin(), row.end(), 0.0F));
  }
  return 2.01F * largest;
}

// The references, ascending, in the order of all histograms.
std::vector<std::int32_t> in_order_of(const std::vector<std::int32_t>& all,
                                      std::span<const std::int32_t> references) {
  std::vector<bool> taken(all.size(), false);
  for (const std::int32_t i : references) taken[static_cast<std::size_t>(i)] = true;
  std::vector<std::int32_t> order;
  order.reserve(references.size());
  std::copy_if(all.begin(), all.end(), std::back_inserter(order),
               [&](std::int32_t i) { return taken[static_cast<std::size_t>(i)]; });
  return order;
}

// groups x bins x 2 x 16: the boxes of `count` things, of which box(i, bin) gives least and greatest value. A
// last group is filled up with boxes at infinity, whose distance is NaN and so never within a limit.
template <class Box>
std::vector<float> boxes_of(std::size_t count, std::size_t bins, Box&& box) {
  std::vector<float> boxes(groups_of(count) * bins * 2 * kLanes, kInfinity);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t bin = 0; bin < bins; ++bin) {
      const auto [least, greatest] = box(i, bin);
      float* const place = &boxes[((i / kLanes * bins + bin) * 2) * kLanes + i % kLanes];
      place[0] = least;
      place[kLanes] = greatest;
    }
  return boxes;
}

}  // namespace

// One query after the other, with working memory that is reused.
class Chi2Query {
 public:
  Chi2Query(const Chi2Search& search, std::size_t k)
      : search_(search),
        k_(k),
        guess_(search.beyond_all_),
        last_above_zero_(search.beyond_all_),
        query_(search.bins_.size()),
        places_(groups_of(search.size()) * kLanes),
        nearest_(k) {
    std::size_t groups = groups_of(search.size());
    for (std::size_t level = 0; level <= search.boxes_.size(); ++level) {
      levels_.emplace_back(groups);
      groups = groups_of(groups);
    }
  }

  // The k nearest references of the q-th query.
  std::span<const Chi2Neighbour> nearest(std::size_t q) {
    start(q);
    const auto [least, most] = search();
    choose(least, most);
    const Level& leaves = levels_[0];
    const std::size_t found = search_.kernel_.places_between(-1, least.value, leaves.distances.data(),
                                                             leaves.count * kLanes, places_.data());
    for (std::size_t c = 0; c < found; ++c) nearest_[c] = neighbour(places_[c]).second;
    std::transform(unsure_.begin(), unsure_.begin() + static_cast<std::ptrdiff_t>(k_ - found),
                   nearest_.begin() + static_cast<std::ptrdiff_t>(found),
                   [](const Placed& near) { return near.second; });
    return nearest_;
  }

  // Sum over the k nearest. `point` is that of the query; `points`, groups x 3 x 16, are those of the
  // table.
  double weighted_sum(std::size_t q, const Vec3& point, const std::vector<float>& points,
                      chi2_kernel::Weight weight) {
    const auto at = [&](std::size_t p, std::size_t axis) {
      return points[(p / kLanes * 3 + axis) * kLanes + p % kLanes];
    };
    const std::array from = {static_cast<float>(point.x()), static_cast<float>(point.y()),
                             static_cast<float>(point.z())};
    start(q);
    if (has_many_alike()) return 0;
    const auto [least, most] = search();
    choose(least, most);
    const Level& leaves = levels_[0];
    double sum = search_.kernel_.weighted_sum(weight, least.value, leaves.distances.data(), points.data(),
                                              from.data(), leaves.groups.data(), leaves.count);
    for (const auto& [p, near] : unsure_) {
      const float dx = at(p, 0) - from[0], dy = at(p, 1) - from[1], dz = at(p, 2) - from[2];
      sum += static_cast<double>(near.chi2 *
                                 chi2_kernel::weight_of(weight, std::sqrt(dx * dx + dy * dy + dz * dz)));
    }
    return sum;
  }

 private:
  // Groups whose 16 members have been looked at, and the distances of, or bounds on, these members.
  struct Level {
    std::size_t count = 0;
    std::vector<std::int32_t> groups;
    std::vector<float> distances;

    explicit Level(std::size_t all_groups) : groups(all_groups), distances(all_groups * kLanes) {}
  };

  using Placed = std::pair<std::size_t, Chi2Neighbour>;  // place in the table first

  // A distance, and how many of the histograms that were looked at are as near.
  struct Limit {
    float value;
    std::size_t count;
  };

  // The first holds k or fewer, all of them among the k nearest; the second holds k or more.
  std::pair<Limit, Limit> search() {
    Limit most{guess_, look(guess_)};
    while (most.count < k_) {
      most.value = raised(most);
      most.count = look(most.value);
    }
    const Limit least = narrow(most);
    guess_ = std::min(kGuess * most.value, search_.beyond_all_);
    if (guess_ > 0) last_above_zero_ = guess_;
    return {least, most};
  }

  // Whether the k nearest are within rounding, as in flat places, where they may be most of the references:
  // it is enough to look at some of them.
  bool has_many_alike() { return look(kAlike * search_.beyond_all_, 2 * groups_of(k_)) >= k_; }

  void start(std::size_t q) {
    std::copy_n(search_.rows_.begin() + static_cast<std::ptrdiff_t>(q * query_.size()), query_.size(),
                query_.begin());
    for (Level& level : levels_) level.count = 0;
    Level& top = levels_.back();
    top.count = top.groups.size();
    std::iota(top.groups.begin(), top.groups.end(), 0);
    search_.kernel_.bounds(search_.boxes_.back().data(), query_.size(), query_.data(), top.groups.data(),
                           top.count, top.distances.data());
  }

  // As the number of points within a distance grows with its third power or so.
  float raised(const Limit& limit) const {
    if (limit.value == 0) return last_above_zero_;
    const float missing = static_cast<float>(k_) / static_cast<float>(std::max<std::size_t>(limit.count, 1));
    return std::min(limit.value * std::min(1.02F + 0.5F * (missing - 1), 2.0F), search_.beyond_all_);
  }

  // Opens the members within the limit that have not been opened, or the first so many of them: adds their
  // groups to the level below.
  std::size_t open(Level& level, float limit, std::size_t most, Level& below) {
    const std::size_t within = std::min(search_.kernel_.places_between(-1, limit, level.distances.data(),
                                                                       level.count * kLanes, places_.data()),
                                        most);
    for (std::size_t i = 0; i < within; ++i) {
      const auto at = static_cast<std::size_t>(places_[i]);
      below.groups[below.count + i] = level.groups[at / kLanes] * static_cast<std::int32_t>(kLanes) +
                                      static_cast<std::int32_t>(at % kLanes);
      level.distances[at] = kOpened;
    }
    return within;
  }

  // Measures all histograms within the limit, and some beyond; or those of the first so many groups. Returns
  // how many are within.
  std::size_t look(float limit, std::size_t most_groups = std::numeric_limits<std::size_t>::max()) {
    for (std::size_t level = levels_.size() - 1; level > 0; --level) {
      Level& below = levels_[level - 1];
      const std::size_t more =
          open(levels_[level], limit * kRounding, level > 1 ? levels_[0].groups.size() : most_groups, below);
      const std::int32_t* const groups = below.groups.data() + below.count;
      float* const distances = below.distances.data() + below.count * kLanes;
      below.count += more;
      if (level > 1)
        search_.kernel_.bounds(search_.boxes_[level - 2].data(), query_.size(), query_.data(), groups, more,
                               distances);
      else
        measure(groups, more, distances);
    }
    return count_up_to(limit);
  }

  std::size_t count_up_to(float limit) const {
    return search_.kernel_.count_up_to(limit, levels_[0].distances.data(), levels_[0].count * kLanes);
  }

  void measure(const std::int32_t* groups, std::size_t count, float* distances) {
    search_.kernel_.distances(search_.table_.data(), query_.size(), query_.data(), groups, count, distances);
    const std::size_t members = (search_.size() - 1) % kLanes + 1;  // of the last group, which is filled up
    const auto last = static_cast<std::int32_t>(groups_of(search_.size()) - 1);
    for (std::size_t g = 0; g < count; ++g)
      if (groups[g] == last)
        std::fill(distances + g * kLanes + members, distances + (g + 1) * kLanes, kInfinity);
  }

  // Lowers `most`, which holds k or more, until it holds k, or a few more than the limit returned, which
  // holds k or fewer.
  Limit narrow(Limit& most) const {
    Limit least{-1, 0};
    for (int probe = 0; probe < 24 && most.count > k_ && most.count - least.count > kSpare; ++probe) {
      const float share =
          (static_cast<float>(k_ - least.count) + 0.5F) / static_cast<float>(most.count - least.count);
      const float low = std::max(least.value, 0.0F);
      const float middle = low + (most.value - low) * (probe % 4 == 3 ? 0.5F : share);
      if (!(middle > least.value && middle < most.value)) break;
      const Limit at{middle, count_up_to(middle)};
      (at.count >= k_ ? most : least) = at;
    }
    return most.count == k_ ? most : least;
  }

  // unsure_: of those beyond `least` and within `most` as many as are missing to k, the nearest and, of equal
  // ones, those of highest index.
  void choose(const Limit& least, const Limit& most) {
    const Level& leaves = levels_[0];
    const std::size_t found = search_.kernel_.places_between(least.value, most.value, leaves.distances.data(),
                                                             leaves.count * kLanes, places_.data());
    unsure_.clear();
    for (std::size_t c = 0; c < found; ++c) unsure_.push_back(neighbour(places_[c]));
    const auto chosen = unsure_.begin() + static_cast<std::ptrdiff_t>(k_ - least.count);
    std::nth_element(unsure_.begin(), chosen, unsure_.end(), [](const Placed& a, const Placed& b) {
      return a.second.chi2 != b.second.chi2 ? a.second.chi2 < b.second.chi2 : a.second.index > b.second.index;
    });
    unsure_.erase(chosen, unsure_.end());
  }

  // The reference at a place among the distances of the leaves, and its place in the table.
  Placed neighbour(std::int32_t place) const {
    const auto at = static_cast<std::size_t>(place);
    const auto group = static_cast<std::size_t>(levels_[0].groups[at / kLanes]);
    const std::size_t in_table = group * kLanes + at % kLanes;
    return {in_table, {search_.order_[in_table], levels_[0].distances[at]}};
  }

  const Chi2Search& search_;
  std::size_t k_;
  float guess_, last_above_zero_;
  std::vector<float> query_;
  std::vector<std::int32_t> places_;
  std::vector<Level> levels_;  // histograms, boxes around groups of them, boxes around groups of boxes ...
  std::vector<Chi2Neighbour> nearest_;
  std::vector<Placed> unsure_;
};

Chi2Search::Chi2Search(const Descriptors& descriptors, std::span<const std::int32_t> references,
                       chi2_kernel::Instructions instructions)
    : bins_(bins_of(descriptors)),
      beyond_all_(beyond_all(descriptors)),
      queries_(grouped_by_likeness(descriptors, bins_)),
      order_(references.empty() ? queries_ : in_order_of(queries_, references)),
      kernel_(chi2_kernel::kernel(instructions)) {
  rows_.reserve(queries_.size() * bins_.size());
  for (const std::int32_t i : queries_)
    for (const std::size_t bin : bins_) rows_.push_back(descriptors.row(static_cast<std::size_t>(i))[bin]);

  const std::size_t n = order_.size(), bins = bins_.size();
  table_.resize(groups_of(n) * bins * kLanes);
  for (std::size_t place = 0; place < n; ++place)
    for (std::size_t b = 0; b < bins; ++b)
      table_[(place / kLanes * bins + b) * kLanes + place % kLanes] =
          descriptors.values[static_cast<std::size_t>(order_[place]) * kBins + bins_[b]];

  std::size_t count = groups_of(n);
  boxes_.push_back(boxes_of(count, bins, [&](std::size_t group, std::size_t bin) {
    const float* const first = &table_[(group * bins + bin) * kLanes];
    const auto [least, greatest] = std::minmax_element(first, first + std::min(kLanes, n - group * kLanes));
    return std::pair(*least, *greatest);
  }));
  while (count > kLanes) {
    const std::size_t below = count;
    count = groups_of(count);
    const std::vector<float>& lower = boxes_.back();
    boxes_.push_back(boxes_of(count, bins, [&](std::size_t group, std::size_t bin) {
      const float* const least = &lower[((group * bins + bin) * 2) * kLanes];
      const float* const greatest = least + kLanes;
      const std::size_t members = std::min(kLanes, below - group * kLanes);
      return std::pair(*std::min_element(least, least + members),
                       *std::max_element(greatest, greatest + members));
    }));
  }
}

std::vector<double> Chi2Search::weighted_sums(std::size_t k, std::span<const Vec3> points,
                                              chi2_kernel::Weight weight) const {
  CHECK_LE(1U, k);
  CHECK_LE(k, size());
  CHECK_EQ(points.size(), queries_.size());
  std::vector<float> by_place(groups_of(size()) * 3 * kLanes);
  for (std::size_t place = 0; place < size(); ++place)
    for (std::size_t axis = 0; axis < 3; ++axis)
      by_place[(place / kLanes * 3 + axis) * kLanes + place % kLanes] = static_cast<float>(
          points[static_cast<std::size_t>(order_[place])][static_cast<Eigen::Index>(axis)]);
  std::vector<double> sums(queries_.size());
  parallel_ranges(queries_.size(), kGrain, [&](std::size_t first, std::size_t last) {
    Chi2Query query(*this, k);
    for (std::size_t q = first; q < last; ++q) {
      const auto i = static_cast<std::size_t>(queries_[q]);
      sums[i] = query.weighted_sum(q, points[i], by_place, weight);
    }
  });
  return sums;
}

void Chi2Search::for_each(std::size_t k, const Visit& visit) const {
  CHECK_LE(1U, k);
  CHECK_LE(k, size());
  Chi2Query query(*this, k);
  for (std::size_t q = 0; q < queries_.size(); ++q)
    visit(static_cast<std::size_t>(queries_[q]), query.nearest(q));
}

}  // namespace salbench
