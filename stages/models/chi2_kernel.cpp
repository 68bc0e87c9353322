// Divisions are real ones and sums run over the bins in order: reciprocal estimates and fused products would
// be faster by little (the divider is the bottleneck) and differ from machine to machine.
#include "stages/models/chi2_kernel.h"

#include <bit>
#include <cstring>

#include <emmintrin.h>

namespace salbench::chi2_kernel {
namespace {

// Turns 0 / 0 into 0, and is lost in any other sum. It is far above the denormal numbers, which are slow.
constexpr float kTiny = 1e-18F;

template <std::size_t width>
struct Vector {
  using Type [[gnu::vector_size(width * sizeof(float))]] = float;
};

// Inlined into each variant below, and compiled there for the variant's instructions.
template <std::size_t width>
[[gnu::always_inline]] inline void compare(const float* table, std::size_t groups, std::size_t bins,
                                           const float* queries, float* distances) {
  using Lanes = typename Vector<width>::Type;
  const std::size_t row = groups * kLanes;
  for (std::size_t j = 0; j < row; j += width) {
    const float* histograms = table + j / kLanes * kLanes * bins + j % kLanes;
    Lanes sums[kQueries] = {};
    for (std::size_t bin = 0; bin < bins; ++bin) {
      Lanes b;
      std::memcpy(&b, histograms + bin * kLanes, sizeof b);
      for (std::size_t q = 0; q < kQueries; ++q) {
        const float a = queries[q * bins + bin];
        const Lanes difference = b - a;
        sums[q] += difference * difference / (b + a + kTiny);
      }
    }
    for (std::size_t q = 0; q < kQueries; ++q) std::memcpy(distances + q * row + j, &sums[q], sizeof sums[q]);
  }
}

void compare_baseline(const float* table, std::size_t groups, std::size_t bins, const float* queries,
                      float* distances) {
  compare<4>(table, groups, bins, queries, distances);
}

[[gnu::target("avx2")]] void compare_avx2(const float* table, std::size_t groups, std::size_t bins,
                                          const float* queries, float* distances) {
  compare<8>(table, groups, bins, queries, distances);
}

[[gnu::target("avx512f")]] void compare_avx512(const float* table, std::size_t groups, std::size_t bins,
                                               const float* queries, float* distances) {
  compare<16>(table, groups, bins, queries, distances);
}

// Bit i is set if values[i] <= limit; there are 16 values.
std::uint32_t mask_up_to(__m128 limit, const float* values) {
  const auto compared = [&](std::size_t i) {
    return _mm_castps_si128(_mm_cmple_ps(_mm_loadu_ps(values + i), limit));
  };
  const __m128i low = _mm_packs_epi32(compared(0), compared(4));
  const __m128i high = _mm_packs_epi32(compared(8), compared(12));
  return static_cast<std::uint32_t>(_mm_movemask_epi8(_mm_packs_epi16(low, high)));
}

}  // namespace

bool supported(Instructions instructions) {
  switch (instructions) {
    case Instructions::avx512:
      return __builtin_cpu_supports("avx512f") != 0;
    case Instructions::avx2:
      return __builtin_cpu_supports("avx2") != 0;
    case Instructions::baseline:
      break;
  }
  return true;
}

Instructions widest_supported() {
  if (supported(Instructions::avx512)) return Instructions::avx512;
  return supported(Instructions::avx2) ? Instructions::avx2 : Instructions::baseline;
}

void distances(Instructions instructions, const float* table, std::size_t groups, std::size_t bins,
               const float* queries, float* distances) {
  switch (instructions) {
    case Instructions::avx512:
      return compare_avx512(table, groups, bins, queries, distances);
    case Instructions::avx2:
      return compare_avx2(table, groups, bins, queries, distances);
    case Instructions::baseline:
      return compare_baseline(table, groups, bins, queries, distances);
  }
}

std::size_t indices_up_to(float limit, const float* values, std::size_t count, std::int32_t* indices) {
  const __m128 limits = _mm_set1_ps(limit);
  std::size_t found = 0;
  for (std::size_t i = 0; i < count; i += 16)
    for (std::uint32_t mask = mask_up_to(limits, values + i); mask != 0; mask &= mask - 1)
      indices[found++] = static_cast<std::int32_t>(i) + std::countr_zero(mask);
  return found;
}

}  // namespace salbench::chi2_kernel
