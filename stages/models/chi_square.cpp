// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/models/chi_square.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>

#include "stages/core/check.h"

namespace salbench {
namespace {

constexpr std::size_t kLanes = 8;
constexpr std::size_t kWidth = 4;  // of vectors that every x86-64 has
using Floats [[gnu::vector_size(kWidth * sizeof(float))]] = float;
using Doubles [[gnu::vector_size(kWidth * sizeof(double))]] = double;

// By bin: a descriptor, and some that it is compared with.
struct Gathered {
  std::array<float, kFpfhBins> own;
  std::array<std::array<float, kLanes>, kFpfhBins> others{};
};

std::array<double, kLanes> distances(const Gathered& of, std::size_t bins) {
  std::array<double, kLanes> result;
  for (std::size_t lane = 0; lane < kLanes; lane += kWidth) {
    Doubles total = {};
    for (std::size_t bin = 0; bin < bins; ++bin) {
      Floats other;
      std::memcpy(&other, &of.others[bin][lane], sizeof other);
      const Floats sum = of.own[bin] + other, difference = of.own[bin] - other;
      const Floats term = difference * difference / sum;
      total += __builtin_convertvector(sum > 0 ? term : Floats{}, Doubles);
    }
    std::memcpy(&result[lane], &total, sizeof total);
  }
  return result;
}

}  // namespace

double chi_square(std::span<const float, kFpfhBins> a, std::span<const float, kFpfhBins> b) {
  Gathered gathered;
  for (std::size_t bin = 0; bin < kFpfhBins; ++bin) {
    gathered.own[bin] = a[bin];
    gathered.others[bin][0] = b[bin];
  }
  return distances(gathered, kFpfhBins)[0];
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

void chi_squares(std::span<const float, kFpfhBins> a, const Descriptors& descriptors,
                 std::span<const std::int32_t> rows, std::span<const std::size_t> bins,
                 std::span<double> result) {
  CHECK_EQ(rows.size(), result.size());
  Gathered gathered;
  for (std::size_t b = 0; b < bins.size(); ++b) gathered.own[b] = a[bins[b]];
  for (std::size_t first = 0; first < rows.size(); first += kLanes) {
    const std::size_t count = std::min(rows.size() - first, kLanes);
    for (std::size_t lane = 0; lane < count; ++lane) {
      const auto row = descriptors.row(static_cast<std::size_t>(rows[first + lane]));
      for (std::size_t b = 0; b < bins.size(); ++b) gathered.others[b][lane] = row[bins[b]];
    }
    const std::array<double, kLanes> some = distances(gathered, bins.size());
    std::copy_n(some.begin(), count, result.begin() + static_cast<std::ptrdiff_t>(first));
  }
}

}  // namespace salbench
