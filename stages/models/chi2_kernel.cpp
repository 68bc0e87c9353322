// SPDX-License-Identifier: GPL-3.0-or-later
// Compiled once per instruction set of Highway, one of which is chosen at run time. Divisions are exact and
// sums run over the bins in order: reciprocal estimates and fused products would be little faster (the
// divider is the bottleneck) and differ between machines.
#include "stages/models/chi2_kernel.h"

#include <array>
#include <cmath>
#include <numeric>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "stages/models/chi2_kernel.cpp"
#include <hwy/foreach_target.h>  // must precede highway.h
#include <hwy/highway.h>

#ifndef SALBENCH_CHI2_TERM  // this file includes itself once per instruction set
#define SALBENCH_CHI2_TERM
namespace salbench::chi2_kernel {
namespace {

// log(1 + d) = 2 artanh(t), t = d / (2 + d) <= 1/2. artanh(t) / t is interpolated in t^2 at Chebyshev's
// nodes, to the precision of floats.
HWY_INLINE float logarithm_beyond_one(float d) {
  const float t = d / (2 + d), z = t * t;
  float series = 0.18307325F;
  for (const float coefficient : {0.08147234F, 0.14694693F, 0.19975236F, 0.33333872F, 0.99999998F})
    series = series * z + coefficient;
  return 2 * t * series;
}

template <Weight weight>
HWY_INLINE float weigh(float distance) {
  return weight == Weight::near ? 1 / (1 + distance) : logarithm_beyond_one(distance);
}

template <Weight weight>
HWY_INLINE float term(float grid, float chi2, float distance) {
  return (chi2 * weigh<weight>(distance) + grid) - grid;
}

}  // namespace
}  // namespace salbench::chi2_kernel
#endif

HWY_BEFORE_NAMESPACE();
namespace salbench::chi2_kernel::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, kLanes>;
constexpr Floats kFloats;
constexpr hn::RebindToSigned<Floats> kIntegers;
constexpr std::size_t kWidth = hn::MaxLanes(kFloats), kParts = kLanes / kWidth;

// (a - b)^2 / (a + b)
template <class V>
HWY_INLINE V term_of_bin(V a, V b) {
  const V difference = b - a;
  return difference * difference / (b + a + hn::Set(kFloats, kTiny));
}

// Processes a few groups of one unit together: a single one would wait for its divisions. A bin that only one
// side fills needs no division, since its terms are tabulated; adding in the order of the bins keeps the
// sums' bits.
template <std::size_t few>
HWY_INLINE void measure(const PackedTable& table, const PackedQuery& query, std::size_t unit,
                        const std::int32_t* groups, float* result) {
  const std::uint64_t filled = table.filled[unit];
  const std::size_t size = hwy::PopCount(filled) * kLanes;  // values of a group
  const float *values[few], *alone[few];
  hn::Vec<Floats> sums[few][kParts];
  for (std::size_t g = 0; g < few; ++g) {
    const std::size_t start = table.starts[unit] + static_cast<std::size_t>(groups[g]) % kUnit * size;
    values[g] = table.values + start;
    alone[g] = table.alone + start;
    for (auto& sum : sums[g]) sum = hn::Zero(kFloats);
  }
  std::size_t at = 0;
  for (std::uint64_t bins = filled | query.filled; bins != 0; bins &= bins - 1) {
    const std::size_t bin = hwy::Num0BitsBelowLS1Bit_Nonzero64(bins);
    if ((filled >> bin & 1) == 0) {
      const auto term = hn::Set(kFloats, query.alone[bin]);
      for (auto& parts : sums)
        for (auto& sum : parts) sum = sum + term;
      continue;
    }
    if ((query.filled >> bin & 1) == 0) {
      for (std::size_t g = 0; g < few; ++g)
        for (std::size_t part = 0; part < kParts; ++part)
          sums[g][part] = sums[g][part] + hn::LoadU(kFloats, alone[g] + at + part * kWidth);
    } else {
      const auto a = hn::Set(kFloats, query.values[bin]);
      for (std::size_t g = 0; g < few; ++g)
        for (std::size_t part = 0; part < kParts; ++part)
          sums[g][part] = sums[g][part] + term_of_bin(a, hn::LoadU(kFloats, values[g] + at + part * kWidth));
    }
    at += kLanes;
  }
  for (std::size_t g = 0; g < few; ++g)
    for (std::size_t part = 0; part < kParts; ++part)
      hn::StoreU(sums[g][part], kFloats, result + g * kLanes + part * kWidth);
}

void distances(const PackedTable& table, const PackedQuery& query, const std::int32_t* groups,
               std::size_t count, float* result) {
  for (std::size_t i = 0, few = 1; i < count; i += few, result += few * kLanes) {
    const std::size_t unit = static_cast<std::size_t>(groups[i]) / kUnit;
    few = 1;
    while (few < kUnit && i + few < count && static_cast<std::size_t>(groups[i + few]) / kUnit == unit) ++few;
    switch (few) {
      case 4:
        measure<4>(table, query, unit, groups + i, result);
        break;
      case 3:
        measure<3>(table, query, unit, groups + i, result);
        break;
      case 2:
        measure<2>(table, query, unit, groups + i, result);
        break;
      default:
        measure<1>(table, query, unit, groups + i, result);
    }
  }
}
static_assert(kUnit == 4);

void bounds(const float* boxes, std::size_t bins, const float* query, const std::int32_t* groups,
            std::size_t count, float* result) {
  for (std::size_t g = 0; g < count; ++g) {
    const float* group = boxes + static_cast<std::size_t>(groups[g]) * bins * 2 * kLanes;
    hn::Vec<Floats> sums[kParts];
    for (auto& sum : sums) sum = hn::Zero(kFloats);
    for (std::size_t bin = 0; bin < bins; ++bin) {
      const auto a = hn::Set(kFloats, query[bin]);
      for (std::size_t part = 0; part < kParts; ++part) {
        const auto least = hn::LoadU(kFloats, group + bin * 2 * kLanes + part * kWidth);
        const auto greatest = hn::LoadU(kFloats, group + (bin * 2 + 1) * kLanes + part * kWidth);
        sums[part] = sums[part] + term_of_bin(a, hn::Min(hn::Max(least, a), greatest));
      }
    }
    for (std::size_t part = 0; part < kParts; ++part)
      hn::StoreU(sums[part], kFloats, result + g * kLanes + part * kWidth);
  }
}

std::size_t count_up_to(float limit, const float* values, std::size_t count) {
  // One counter per part of a group: a single one would be a bottleneck.
  const auto limits = hn::Set(kFloats, limit);
  hn::Vec<decltype(kIntegers)> counts[kParts];
  for (auto& part : counts) part = hn::Zero(kIntegers);
  for (std::size_t i = 0; i < count; i += kLanes)
    for (std::size_t part = 0; part < kParts; ++part) {
      const auto up_to = hn::LoadU(kFloats, values + i + part * kWidth) <= limits;
      counts[part] = counts[part] - hn::VecFromMask(kIntegers, hn::RebindMask(kIntegers, up_to));
    }
  for (std::size_t part = 1; part < kParts; ++part) counts[0] = counts[0] + counts[part];
  return static_cast<std::size_t>(hn::GetLane(hn::SumOfLanes(kIntegers, counts[0])));
}

// Positions of the set bits, for each mask of eight bits.
constexpr auto kSetBits = [] {
  std::array<std::array<std::uint8_t, 8>, 256> all{};
  for (std::size_t mask = 0; mask < all.size(); ++mask)
    for (std::size_t bit = 0, count = 0; bit < 8; ++bit)
      if ((mask >> bit & 1) != 0) all[mask][count++] = static_cast<std::uint8_t>(bit);
  return all;
}();

// Writes a whole vector each time; the next one overwrites invalid entries. Highway 1.0's own Compress copies
// a table for each vector with g++ 12, unless the processor has an instruction for it.
std::size_t places_between(float low, float high, const float* values, std::size_t count,
                           std::int32_t* places) {
  constexpr hn::CappedTag<std::int32_t, 8> kPlaces;
  constexpr hn::Rebind<std::uint8_t, decltype(kPlaces)> kBytes;
  const auto lows = hn::Set(kFloats, low), highs = hn::Set(kFloats, high);
  auto at = hn::Iota(kIntegers, 0);  // NOLINT(clang-analyzer-deadcode.DeadStores): in one of two branches
  std::size_t found = 0;
  for (std::size_t i = 0; i < count; i += kWidth) {
    const auto some = hn::LoadU(kFloats, values + i);
    const auto between = hn::And(some > lows, some <= highs);
    if constexpr (kWidth == kLanes) {
      const auto mask = hn::RebindMask(kIntegers, between);
      hn::StoreU(hn::Compress(at, mask), kIntegers, places + found);
      at = at + hn::Set(kIntegers, kLanes);
      found += hn::CountTrue(kIntegers, mask);
    } else {
      std::uint8_t mask[8];
      hn::StoreMaskBits(kFloats, between, mask);
      const auto set = hn::PromoteTo(kPlaces, hn::LoadU(kBytes, kSetBits[mask[0]].data()));
      hn::StoreU(set + hn::Set(kPlaces, static_cast<std::int32_t>(i)), kPlaces, places + found);
      found += hwy::PopCount(mask[0]);
    }
  }
  return found;
}

// Plain loops over the lanes, which the compiler vectorises. Each lane has its own sum.
template <Weight weight>
HWY_INLINE double sum_weighted(float grid, float limit, const float* chi2, const float* places,
                               const float* from, const std::int32_t* groups, std::size_t count) {
  std::array<double, kLanes> sums{};
  for (std::size_t g = 0; g < count; ++g, chi2 += kLanes) {
    const float* const x = places + static_cast<std::size_t>(groups[g]) * 3 * kLanes;
    const float* const y = x + kLanes;
    const float* const z = y + kLanes;
    std::array<float, kLanes> terms;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const float dx = x[lane] - from[0], dy = y[lane] - from[1], dz = z[lane] - from[2];
      const float any = term<weight>(grid, chi2[lane], std::sqrt(dx * dx + dy * dy + dz * dz));
      terms[lane] = chi2[lane] <= limit ? any : 0;
    }
    for (std::size_t lane = 0; lane < kLanes; ++lane) sums[lane] += static_cast<double>(terms[lane]);
  }
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

double weighted_sum(Weight weight, float grid, float limit, const float* chi2, const float* places,
                    const float* from, const std::int32_t* groups, std::size_t count) {
  return weight == Weight::near ? sum_weighted<Weight::near>(grid, limit, chi2, places, from, groups, count)
                                : sum_weighted<Weight::far>(grid, limit, chi2, places, from, groups, count);
}

}  // namespace

const Kernel& kernel() {
  static const Kernel all = {
      hwy::TargetName(HWY_TARGET), distances, bounds, count_up_to, places_between, weighted_sum};
  return all;
}

}  // namespace salbench::chi2_kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace salbench::chi2_kernel {

HWY_EXPORT(kernel);
const Kernel& kernel() { return HWY_DYNAMIC_DISPATCH(kernel)(); }

float term_of(Weight weight, float grid, float chi2, float distance) {
  return weight == Weight::near ? term<Weight::near>(grid, chi2, distance)
                                : term<Weight::far>(grid, chi2, distance);
}

}  // namespace salbench::chi2_kernel
#endif
