// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/distribution.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "stages/core/check.h"

namespace salbench {

// Values are sorted with their points, which is faster than looking them up; those of the smallest value,
// often half of a shape, not at all.
Order ascending_order(std::span<const double> field) {
  CHECK_EQ(std::ranges::none_of(field, [](double value) { return std::isnan(value); }), true);
  struct Entry {
    double value;
    std::uint32_t point;
  };
  const double smallest = field.empty() ? 0 : std::ranges::min(field);
  Order order;
  order.reserve(field.size());
  std::vector<Entry> larger;
  larger.reserve(field.size());
  for (std::uint32_t i = 0; i < field.size(); ++i)
    if (field[i] == smallest)
      order.push_back(i);
    else
      larger.push_back({field[i], i});
  std::ranges::sort(larger, [](const Entry& a, const Entry& b) {
    return a.value != b.value ? a.value < b.value : a.point < b.point;
  });
  for (const Entry& entry : larger) order.push_back(entry.point);
  return order;
}

Distribution distribution(std::span<const double> field, const Order& order, const Measure& measure) {
  const std::size_t n = field.size();
  CHECK_EQ(order.size(), n);
  CHECK_EQ(measure.size(), n);
  Distribution result{ScalarField(n), {}, {}};
  double weight = 0;
  for (std::size_t first = 0, end = 0; first < n; first = end) {
    const double value = field[order[first]], below = weight;
    do {
      weight += measure.weight[order[end]];
      result.values.push_back(value);
      result.reached.push_back(weight);
    } while (++end < n && field[order[end]] == value);
    for (std::size_t k = first; k < end; ++k) result.mid[order[k]] = below + (weight - below) / 2;
  }
  return result;
}

double Distribution::weight_below(double value) const {
  const auto points = std::ranges::lower_bound(values, value) - values.begin();
  return points == 0 ? 0 : reached[static_cast<std::size_t>(points) - 1];
}

double Distribution::quantile(double u) const {
  const auto at = std::ranges::upper_bound(reached, u * total());
  return at == reached.end() ? values.back() : values[static_cast<std::size_t>(at - reached.begin())];
}

namespace {

// Distribution::quantile of many numbers, a thousandth of the points searched for each.
class Quantiles {
 public:
  explicit Quantiles(const Distribution& map) : map_(map) {
    for (std::size_t cell = 0; cell <= kCells; ++cell)
      first_.push_back(
          std::ranges::upper_bound(map.reached, static_cast<double>(cell) / kCells * map.total()));
  }
  double operator()(double u) const {
    const auto cell = static_cast<std::size_t>(u * kCells);
    const auto at = std::upper_bound(first_[cell], first_[cell + 1], u * map_.total());
    return map_.values[static_cast<std::size_t>(std::min(at, map_.reached.end() - 1) - map_.reached.begin())];
  }

 private:
  static constexpr std::size_t kCells = 1024;
  const Distribution& map_;
  std::vector<std::vector<double>::const_iterator> first_;  // [cell]: what may be the quantile of its numbers
};

}  // namespace

RandomValues::RandomValues(std::span<const double> map, Rng rng) {
  if (map.size() >= 2) next_ = [map, rng]() mutable { return map[rng.below(map.size() - 1) + 1]; };
}

RandomValues::RandomValues(const Distribution& map, Rng rng) {
  if (map.total() > 0) next_ = [of = Quantiles(map), rng]() mutable { return of(rng.uniform()); };
}

std::span<const double> RandomValues::first(std::size_t count) {
  while (values_.size() < count) values_.push_back(next_());
  return std::span(values_).first(count);
}

}  // namespace salbench
