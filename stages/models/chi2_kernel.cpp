// SPDX-License-Identifier: GPL-3.0-or-later
// Divisions are real ones and sums run over the bins in order: reciprocal estimates and fused products would
// be faster by little (the divider is the bottleneck) and differ from machine to machine.
#include "stages/models/chi2_kernel.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>

#include <immintrin.h>

namespace salbench::chi2_kernel {
namespace {

// Turns 0 / 0 into 0, and is lost in any other sum. It is far above the denormal numbers, which are slow.
constexpr float kTiny = 1e-18F;

template <std::size_t width>
struct Vector {
  using Floats [[gnu::vector_size(width * sizeof(float))]] = float;
  using Integers [[gnu::vector_size(width * sizeof(float))]] = std::int32_t;
};

// Vectors are handed over by reference: the calling convention of wide ones differs between the variants.
template <class Lanes>
[[gnu::always_inline]] inline void load(const float* values, Lanes& lanes) {
  std::memcpy(&lanes, values, sizeof lanes);
}

// The loops below are inlined into each variant, and compiled there for the variant's instructions. The parts
// of a group go side by side: one alone would wait for its divisions.
template <std::size_t width>
[[gnu::always_inline]] inline void compare(const float* table, std::size_t bins, const float* query,
                                           const std::int32_t* groups, std::size_t count, float* distances) {
  using Floats = typename Vector<width>::Floats;
  for (std::size_t g = 0; g < count; ++g) {
    const float* group = table + static_cast<std::size_t>(groups[g]) * bins * kLanes;
    std::array<Floats, kLanes / width> sums = {};
    for (std::size_t bin = 0; bin < bins; ++bin) {
      const float a = query[bin];
      for (std::size_t part = 0; part < kLanes / width; ++part) {
        Floats b;
        load(group + bin * kLanes + part * width, b);
        const auto difference = b - a;
        sums[part] += difference * difference / (b + a + kTiny);
      }
    }
    std::memcpy(distances + g * kLanes, &sums, sizeof sums);
  }
}

template <std::size_t width>
[[gnu::always_inline]] inline void bound(const float* boxes, std::size_t bins, const float* query,
                                         const std::int32_t* groups, std::size_t count, float* bounds) {
  using Floats = typename Vector<width>::Floats;
  for (std::size_t g = 0; g < count; ++g) {
    const float* group = boxes + static_cast<std::size_t>(groups[g]) * bins * 2 * kLanes;
    std::array<Floats, kLanes / width> sums = {};
    for (std::size_t bin = 0; bin < bins; ++bin) {
      const float a = query[bin];
      for (std::size_t part = 0; part < kLanes / width; ++part) {
        Floats least, greatest;
        load(group + bin * 2 * kLanes + part * width, least);
        load(group + (bin * 2 + 1) * kLanes + part * width, greatest);
        Floats b = least > a ? least : a + Floats{};
        b = b > greatest ? greatest : b;
        const auto difference = b - a;
        sums[part] += difference * difference / (b + a + kTiny);
      }
    }
    std::memcpy(bounds + g * kLanes, &sums, sizeof sums);
  }
}

template <std::size_t width>
[[gnu::always_inline]] inline std::size_t count_values(float limit, const float* values, std::size_t count) {
  // A counter for each part of a group: one alone would be waited for.
  constexpr std::size_t kParts = kLanes / width;
  std::array<typename Vector<width>::Integers, kParts> counts = {};
  for (std::size_t i = 0; i < count; i += kLanes)
    for (std::size_t part = 0; part < kParts; ++part) {
      typename Vector<width>::Floats lanes;
      load(values + i + part * width, lanes);
      counts[part] -= lanes <= limit;
    }
  std::size_t sum = 0;
  for (const auto& part : counts)
    for (std::size_t lane = 0; lane < width; ++lane) sum += static_cast<std::size_t>(part[lane]);
  return sum;
}

// Bit i is set if low < values[i] <= high; there are 16 values.
std::uint32_t mask_between(float low, float high, const float* values) {
  const __m128 lows = _mm_set1_ps(low), highs = _mm_set1_ps(high);
  const auto compared = [&](std::size_t i) {
    const __m128 four = _mm_loadu_ps(values + i);
    return _mm_castps_si128(_mm_and_ps(_mm_cmpgt_ps(four, lows), _mm_cmple_ps(four, highs)));
  };
  const __m128i lower = _mm_packs_epi32(compared(0), compared(4));
  const __m128i upper = _mm_packs_epi32(compared(8), compared(12));
  return static_cast<std::uint32_t>(_mm_movemask_epi8(_mm_packs_epi16(lower, upper)));
}

std::size_t places_baseline(float low, float high, const float* values, std::size_t count,
                            std::int32_t* places) {
  std::size_t found = 0;
  for (std::size_t i = 0; i < count; i += kLanes)
    for (std::uint32_t mask = mask_between(low, high, values + i); mask != 0; mask &= mask - 1)
      places[found++] = static_cast<std::int32_t>(i) + std::countr_zero(mask);
  return found;
}

// For each mask of eight bits, which are set.
constexpr auto kSetBits = [] {
  std::array<std::array<std::uint8_t, 8>, 256> all{};
  for (std::size_t mask = 0; mask < all.size(); ++mask)
    for (std::size_t bit = 0, count = 0; bit < 8; ++bit)
      if ((mask >> bit & 1) != 0) all[mask][count++] = static_cast<std::uint8_t>(bit);
  return all;
}();

// In the wide variants each vector's places are written whole, and the next one's over those that are none.
[[gnu::target("avx2,popcnt")]] std::size_t places_avx2(float low, float high, const float* values,
                                                       std::size_t count, std::int32_t* places) {
  constexpr std::size_t kWidth = 8;
  const __m256 lows = _mm256_set1_ps(low), highs = _mm256_set1_ps(high);
  std::size_t found = 0;
  for (std::size_t i = 0; i < count; i += kWidth) {
    const __m256 eight = _mm256_loadu_ps(values + i);
    const auto mask = static_cast<std::uint32_t>(_mm256_movemask_ps(
        _mm256_and_ps(_mm256_cmp_ps(eight, lows, _CMP_GT_OQ), _mm256_cmp_ps(eight, highs, _CMP_LE_OQ))));
    const __m256i set =
        _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(kSetBits[mask].data())));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(places + found),
                        _mm256_add_epi32(set, _mm256_set1_epi32(static_cast<std::int32_t>(i))));
    found += static_cast<std::size_t>(std::popcount(mask));
  }
  return found;
}

[[gnu::target("avx512f,popcnt")]] std::size_t places_avx512(float low, float high, const float* values,
                                                            std::size_t count, std::int32_t* places) {
  const __m512 lows = _mm512_set1_ps(low), highs = _mm512_set1_ps(high);
  __m512i at = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  std::size_t found = 0;
  for (std::size_t i = 0; i < count; i += kLanes) {
    const __m512 all = _mm512_loadu_ps(values + i);
    const __mmask16 mask =
        _mm512_mask_cmp_ps_mask(_mm512_cmp_ps_mask(all, lows, _CMP_GT_OQ), all, highs, _CMP_LE_OQ);
    _mm512_storeu_si512(places + found, _mm512_maskz_compress_epi32(mask, at));
    at = _mm512_add_epi32(at, _mm512_set1_epi32(static_cast<std::int32_t>(kLanes)));
    found += static_cast<std::size_t>(std::popcount(static_cast<std::uint32_t>(mask)));
  }
  return found;
}

// log(1 + d) = 2 artanh(t), t = d / (2 + d) <= 1/2. artanh(t) / t is interpolated in t^2 at Chebyshev's
// nodes, to the precision of floats.
[[gnu::always_inline]] inline float logarithm_beyond_one(float d) {
  const float t = d / (2 + d), z = t * t;
  float series = 0.18307325F;
  for (const float coefficient : {0.08147234F, 0.14694693F, 0.19975236F, 0.33333872F, 0.99999998F})
    series = series * z + coefficient;
  return 2 * t * series;
}

template <Weight weight>
[[gnu::always_inline]] inline float weigh(float distance) {
  return weight == Weight::near ? 1 / (1 + distance) : logarithm_beyond_one(distance);
}

template <Weight weight>
[[gnu::always_inline]] inline float term(float grid, float chi2, float distance) {
  return (chi2 * weigh<weight>(distance) + grid) - grid;
}

// Plain loops over the lanes, which the compiler turns into vectors. Each lane has a sum of its own.
template <Weight weight>
[[gnu::always_inline]] inline double sum_weighted(float grid, float limit, const float* chi2,
                                                  const float* places, const float* from,
                                                  const std::int32_t* groups, std::size_t count) {
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

[[gnu::always_inline]] inline double sum_weighted(Weight weight, float grid, float limit, const float* chi2,
                                                  const float* places, const float* from,
                                                  const std::int32_t* groups, std::size_t count) {
  return weight == Weight::near ? sum_weighted<Weight::near>(grid, limit, chi2, places, from, groups, count)
                                : sum_weighted<Weight::far>(grid, limit, chi2, places, from, groups, count);
}

#define SALBENCH_VARIANT(name, isa, width)                                                                   \
  [[gnu::target(isa)]] void distances_##name(const float* table, std::size_t bins, const float* query,       \
                                             const std::int32_t* groups, std::size_t count, float* result) { \
    compare<width>(table, bins, query, groups, count, result);                                               \
  }                                                                                                          \
  [[gnu::target(isa)]] void bounds_##name(const float* boxes, std::size_t bins, const float* query,          \
                                          const std::int32_t* groups, std::size_t count, float* result) {    \
    bound<width>(boxes, bins, query, groups, count, result);                                                 \
  }                                                                                                          \
  [[gnu::target(isa)]] std::size_t count_##name(float limit, const float* values, std::size_t count) {       \
    return count_values<width>(limit, values, count);                                                        \
  }                                                                                                          \
  [[gnu::target(isa)]] double weighted_sum_##name(Weight weight, float grid, float limit, const float* chi2, \
                                                  const float* places, const float* from,                    \
                                                  const std::int32_t* groups, std::size_t count) {           \
    return sum_weighted(weight, grid, limit, chi2, places, from, groups, count);                             \
  }
SALBENCH_VARIANT(baseline, "sse2", 4)
SALBENCH_VARIANT(avx2, "avx2", 8)
SALBENCH_VARIANT(avx512, "avx512f,avx512vl", 16)
#undef SALBENCH_VARIANT

}  // namespace

bool supported(Instructions instructions) {
  switch (instructions) {
    case Instructions::avx512:
      return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512vl") != 0 &&
             supported(Instructions::avx2);
    case Instructions::avx2:
      return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("popcnt") != 0;
    case Instructions::baseline:
      break;
  }
  return true;
}

Instructions widest_supported() {
  if (supported(Instructions::avx512)) return Instructions::avx512;
  return supported(Instructions::avx2) ? Instructions::avx2 : Instructions::baseline;
}

float term_of(Weight weight, float grid, float chi2, float distance) {
  return weight == Weight::near ? term<Weight::near>(grid, chi2, distance)
                                : term<Weight::far>(grid, chi2, distance);
}

const Kernel& kernel(Instructions instructions) {
  static constexpr std::array kernels = {
      Kernel{distances_baseline, bounds_baseline, count_baseline, places_baseline, weighted_sum_baseline},
      Kernel{distances_avx2, bounds_avx2, count_avx2, places_avx2, weighted_sum_avx2},
      Kernel{distances_avx512, bounds_avx512, count_avx512, places_avx512, weighted_sum_avx512}};
  return kernels[static_cast<std::size_t>(instructions)];
}

}  // namespace salbench::chi2_kernel
