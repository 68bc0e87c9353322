// SPDX-License-Identifier: GPL-3.0-or-later
// Points are sorted by radix, which takes a fifth of the time of a comparison sort of 10 000 values: without
// it, two sorts were most of what all metrics together cost. The upper half of a double's bits decides nearly
// always. Those of the smallest value, often half of a shape and more, come first and are not sorted at all.
#include "stages/metrics/distribution.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>

#include "stages/core/check.h"

namespace salbench {
namespace {

constexpr unsigned kIndexBits = 32, kDigitBits = 11, kDigits = 3;  // 33 bits hold the 32 of a key
constexpr std::size_t kBuckets = std::size_t{1} << kDigitBits;
constexpr std::size_t kWorthRadix = 512;  // points; below, the buckets cost more than comparisons

// The upper half of the bits, so that keys never descend as the doubles ascend. Adding 0 makes -0 the 0 it
// equals.
std::uint64_t key_of(double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value + 0.0);
  constexpr std::uint64_t kSign = std::uint64_t{1} << 63U;
  return ((bits & kSign) != 0 ? ~bits : bits | kSign) >> kIndexBits;
}

std::size_t digit(std::uint64_t entry, unsigned which) {
  return (entry >> (kIndexBits + which * kDigitBits)) & (kBuckets - 1);
}

// Sorts what shares a key.
void sort_within_keys(std::span<const double> field, std::span<const std::uint64_t> entries,
                      std::span<std::uint32_t> order) {
  const auto smaller = [&](std::uint32_t a, std::uint32_t b) { return field[a] < field[b]; };
  for (std::size_t first = 0, end = 0; first < entries.size(); first = end) {
    while (end < entries.size() && entries[end] >> kIndexBits == entries[first] >> kIndexBits) ++end;
    const auto begin = order.begin() + static_cast<std::ptrdiff_t>(first);
    const auto last = order.begin() + static_cast<std::ptrdiff_t>(end);
    if (!std::is_sorted(begin, last, smaller)) std::stable_sort(begin, last, smaller);
  }
}

// Ascending. `sorted` has as much room.
void sort_entries(std::unique_ptr<std::uint64_t[]>& entries, std::unique_ptr<std::uint64_t[]>& sorted,
                  std::size_t n) {
  if (n < kWorthRadix) {
    std::sort(entries.get(), entries.get() + n);
    return;
  }
  std::array<std::array<std::uint32_t, kBuckets>, kDigits> counts{};
  for (const std::uint64_t entry : std::span(entries.get(), n))
    for (unsigned d = 0; d < kDigits; ++d) ++counts[d][digit(entry, d)];
  for (unsigned d = 0; d < kDigits; ++d) {
    if (counts[d][digit(entries[0], d)] == n) continue;  // all alike
    std::uint32_t start = 0;
    for (std::uint32_t& bucket : counts[d]) start += std::exchange(bucket, start);
    for (const std::uint64_t entry : std::span(entries.get(), n))
      sorted[counts[d][digit(entry, d)]++] = entry;
    entries.swap(sorted);
  }
}

}  // namespace

Order ascending_order(std::span<const double> field) {
  const std::size_t n = field.size();
  if (n == 0) return {};
  const double smallest =
      Eigen::Map<const Eigen::ArrayXd>(field.data(), static_cast<Eigen::Index>(n)).minCoeff();
  // Key above index; all is written before it is read.
  auto entries = std::make_unique_for_overwrite<std::uint64_t[]>(n);
  auto sorted = std::make_unique_for_overwrite<std::uint64_t[]>(n);
  Order order(n);
  std::size_t at_smallest = 0, above = 0;
  bool any_nan = false;
  for (std::size_t i = 0; i < n; ++i) {  // one of the two is overwritten
    any_nan |= field[i] != field[i];
    order[at_smallest] = static_cast<std::uint32_t>(i);
    entries[above] = i;
    const bool is_smallest = field[i] == smallest;
    at_smallest += is_smallest ? 1 : 0;
    above += is_smallest ? 0 : 1;
  }
  CHECK_EQ(any_nan, false);
  for (std::uint64_t& entry : std::span(entries.get(), above))
    entry = key_of(field[entry]) << kIndexBits | entry;
  sort_entries(entries, sorted, above);
  for (std::size_t k = 0; k < above; ++k) order[at_smallest + k] = static_cast<std::uint32_t>(entries[k]);
  sort_within_keys(field, {entries.get(), above}, std::span(order).subspan(at_smallest));
  return order;
}

namespace {

// The mid-ranks; each(k, value, weight up to it) of the points in their order.
template <class Each>
MidRanks ranked(std::span<const double> field, const Order& order, const Measures& measures,
                const Each& each) {
  const std::size_t n = field.size();
  CHECK_EQ(order.size(), n);
  CHECK_EQ(measures.size(), n);
  const bool by_area = !measures.area.empty();
  MidRanks mid{ScalarField(n), ScalarField(by_area ? n : 0)};
  PerWeighting weight(0, 0);
  for (std::size_t first = 0, end = 0; first < n; first = end) {
    const double value = field[order[first]];
    const PerWeighting below = weight;
    do {
      weight += measures.weight(order[end]);
      each(end, value, weight);
    } while (++end < n && field[order[end]] == value);
    const PerWeighting middle = below + (weight - below) / 2;
    for (std::size_t k = first; k < end; ++k) {
      mid.by_vertex[order[k]] = middle[0];
      if (by_area) mid.by_area[order[k]] = middle[1];
    }
  }
  return mid;
}

}  // namespace

MidRanks mid_ranks(std::span<const double> field, const Order& order, const Measures& measures) {
  return ranked(field, order, measures, [](std::size_t, double, const PerWeighting&) {});
}

std::array<Distribution, 2> distributions(std::span<const double> field, const Order& order,
                                          const Measures& measures) {
  const bool by_area = !measures.area.empty();
  Distribution per_vertex{{}, std::vector<double>(field.size()), std::vector<double>(field.size())}, per_area;
  if (by_area) per_area.reached.resize(field.size());
  MidRanks mid = ranked(field, order, measures, [&](std::size_t k, double value, const PerWeighting& weight) {
    per_vertex.values[k] = value;
    per_vertex.reached[k] = weight[0];
    if (by_area) per_area.reached[k] = weight[1];
  });
  per_vertex.mid = std::move(mid.by_vertex);
  if (by_area) {
    per_area.mid = std::move(mid.by_area);
    per_area.values = per_vertex.values;
  }
  return {std::move(per_vertex), std::move(per_area)};
}

std::size_t Distribution::points_below(double value) const {
  return static_cast<std::size_t>(std::lower_bound(values.begin(), values.end(), value) - values.begin());
}

double Distribution::quantile(double u) const {
  const auto at = std::upper_bound(reached.begin(), reached.end(), u * total());
  return at == reached.end() ? values.back() : values[static_cast<std::size_t>(at - reached.begin())];
}

}  // namespace salbench
