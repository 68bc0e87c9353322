// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/chi_square.h"

#include <algorithm>
#include <array>
#include <cstddef>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "stages/models/chi_square.cpp"
#include <hwy/foreach_target.h>  // must precede highway.h
#include <hwy/highway.h>

#include "stages/core/check.h"

HWY_BEFORE_NAMESPACE();
namespace salbench::HWY_NAMESPACE {
namespace {

constexpr std::size_t kLanes = 8;  // rows of a block

// Distances of a descriptor, given by bin, from the rows of a block.
void distances(const float* own, const float* block, std::size_t bins, double* result) {
  namespace hn = hwy::HWY_NAMESPACE;
  constexpr hn::CappedTag<float, kLanes> kFloats;
  constexpr hn::CappedTag<double, kLanes> kDoubles;
  constexpr hn::Rebind<float, decltype(kDoubles)> kPromoted;
  constexpr std::size_t kWidth = hn::MaxLanes(kFloats), kPart = hn::MaxLanes(kDoubles);
  for (std::size_t lane = 0; lane < kLanes; lane += kWidth) {
    hn::Vec<decltype(kDoubles)> totals[kWidth / kPart];
    for (auto& total : totals) total = hn::Zero(kDoubles);
    for (std::size_t bin = 0; bin < bins; ++bin) {
      const auto a = hn::Set(kFloats, own[bin]), b = hn::LoadU(kFloats, block + bin * kLanes + lane);
      const auto sum = a + b, difference = a - b;
      alignas(64) float terms[kWidth];
      hn::Store(hn::IfThenElseZero(sum > hn::Zero(kFloats), difference * difference / sum), kFloats, terms);
      for (std::size_t part = 0; part < kWidth / kPart; ++part)
        totals[part] = totals[part] + hn::PromoteTo(kDoubles, hn::Load(kPromoted, terms + part * kPart));
    }
    for (std::size_t part = 0; part < kWidth / kPart; ++part)
      hn::StoreU(totals[part], kDoubles, result + lane + part * kPart);
  }
}

}  // namespace
}  // namespace salbench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace salbench {

using HWY_NAMESPACE::kLanes;
HWY_EXPORT(distances);

double chi_square(std::span<const float, kFpfhBins> a, std::span<const float, kFpfhBins> b) {
  std::array<float, kFpfhBins * kLanes> block{};
  for (std::size_t bin = 0; bin < kFpfhBins; ++bin) block[bin * kLanes] = b[bin];
  std::array<double, kLanes> result;
  HWY_DYNAMIC_DISPATCH(distances)(a.data(), block.data(), kFpfhBins, result.data());
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
    HWY_DYNAMIC_DISPATCH(distances)(own.data(), block, bins_.size(), some.data());
    std::copy_n(some.begin(), std::min(count_ - first, kLanes), &result[first]);
  }
}

}  // namespace salbench
#endif
