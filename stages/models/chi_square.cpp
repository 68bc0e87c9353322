// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/chi_square.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>

#include "stages/core/check.h"

namespace salbench {
namespace {

constexpr std::size_t kLanes = 8;  // rows of a block

// Vectors as wide as the processor has them.
template <std::size_t kBytes>
struct Vectors {
  static constexpr std::size_t kFloats = kBytes / sizeof(float);
  typedef float Floats __attribute__((vector_size(kBytes)));
  typedef float HalfFloats __attribute__((vector_size(kBytes / 2)));
  typedef double Doubles __attribute__((vector_size(kBytes)));
};

// The distances of a descriptor, given by bin, from the rows of a block.
template <std::size_t kBytes>
[[gnu::always_inline]] inline void distances(const float* own, const float* block, std::size_t bins,
                                             double* result) {
  using V = Vectors<kBytes>;
  constexpr std::size_t kFloats = V::kFloats, kHalf = kFloats / 2;
  for (std::size_t lane = 0; lane < kLanes; lane += kFloats) {
    typename V::Doubles totals[2] = {};
    for (std::size_t bin = 0; bin < bins; ++bin) {
      typename V::Floats other;
      std::memcpy(&other, block + bin * kLanes + lane, sizeof other);
      const typename V::Floats sum = own[bin] + other, difference = own[bin] - other;
      const typename V::Floats quotient = difference * difference / sum;
      const typename V::Floats term = sum > 0 ? quotient : typename V::Floats{};
      typename V::HalfFloats halves[2];
      std::memcpy(halves, &term, sizeof term);
      for (std::size_t half = 0; half < 2; ++half)
        totals[half] += __builtin_convertvector(halves[half], typename V::Doubles);
    }
    for (std::size_t half = 0; half < 2; ++half)
      std::memcpy(result + lane + half * kHalf, &totals[half], sizeof totals[half]);
  }
}

using Distances = void (*)(const float* own, const float* block, std::size_t bins, double* result);

void distances_baseline(const float* own, const float* block, std::size_t bins, double* result) {
  distances<16>(own, block, bins, result);
}
[[gnu::target("avx2")]] void distances_avx2(const float* own, const float* block, std::size_t bins,
                                            double* result) {
  distances<32>(own, block, bins, result);
}

const Distances kDistances = __builtin_cpu_supports("avx2") != 0 ? distances_avx2 : distances_baseline;

}  // namespace

double chi_square(std::span<const float, kFpfhBins> a, std::span<const float, kFpfhBins> b) {
  std::array<float, kFpfhBins * kLanes> block{};
  for (std::size_t bin = 0; bin < kFpfhBins; ++bin) block[bin * kLanes] = b[bin];
  std::array<double, kLanes> result;
  kDistances(a.data(), block.data(), kFpfhBins, result.data());
  return result[0];
}

std::vector<std::size_t> used_bins(const Descriptors& descriptors) {
  std::array<bool, kFpfhBins> used{};
  for (std::size_t i = 0; i < descriptors.values.size(); ++i)
    if (descriptors.values[i] != 0) used[i % kFpfhBins] = true;
  std::vector<std::size_t> bins;
  for (std::size_t bin = 0; bin < kFpfhBins; ++bin)
    if (used[bin]) bins.push_back(bin);
  return bins;
}

void ChiSquares::set_rows(const Descriptors& descriptors, std::span<const std::int32_t> rows) {
  count_ = rows.size();
  blocks_.resize((count_ + kLanes - 1) / kLanes * kLanes * bins_.size());
  for (std::size_t i = 0; i < count_; ++i) {
    const auto row = descriptors.row(static_cast<std::size_t>(rows[i]));
    float* lane = blocks_.data() + i / kLanes * kLanes * bins_.size() + i % kLanes;
    for (std::size_t b = 0; b < bins_.size(); ++b) lane[b * kLanes] = row[bins_[b]];
  }
}

void ChiSquares::measure(std::span<const float, kFpfhBins> from, std::span<double> result) const {
  CHECK_EQ(result.size(), count_);
  std::array<float, kFpfhBins> own;
  for (std::size_t b = 0; b < bins_.size(); ++b) own[b] = from[bins_[b]];
  const float* block = blocks_.data();
  for (std::size_t first = 0; first < count_; first += kLanes, block += kLanes * bins_.size()) {
    std::array<double, kLanes> some;
    kDistances(own.data(), block, bins_.size(), some.data());
    std::copy_n(some.begin(), std::min(count_ - first, kLanes), &result[first]);
  }
}

}  // namespace salbench
