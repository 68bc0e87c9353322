// SPDX-License-Identifier: GPL-3.0-or-later
// Relation of two oriented points, and the histogram bins that it votes for. [rusu2009]
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "stages/core/types.h"

namespace salbench {

// Angles in the Darboux frame u, v, w of the source p.
struct DarbouxTriple {
  double alpha = 0;  // v . n_q, in [-1, 1]
  double phi = 0;    // u . (q - p) / |q - p|, in [-1, 1]
  double theta = 0;  // atan2(w . n_q, u . n_q), in [-pi, pi]
};

// All 0 if the points coincide or the frame is undefined (q straight above p). Normals have unit length. With
// `swap`, the source is the point whose normal makes the smaller angle with the line between them, which
// makes the triple symmetric in p and q. [rusu2009]
DarbouxTriple pair_features(const Vec3& p, const Vec3& n_p, const Vec3& q, const Vec3& n_q, bool swap);

// Only bins of a feature's absolute value are filled, out of 11 over its range: the upper half of the middle
// one, and the 5 above it.
inline constexpr std::size_t kBlockBins = 11;
inline constexpr std::size_t kFirstFilled = 5;
inline constexpr std::size_t kFilledBins = kBlockBins - kFirstFilled;

struct PairBins {
  std::uint8_t theta, alpha, phi;  // 0..5, counted from the middle bin
  bool both_ways;                  // swapping p and q gives the same bins
};

// Bins of pair_features(), mostly found from signs of differences, without computing angles. p and q do not
// coincide.
PairBins pair_bins(const Vec3& p, const Vec3& n_p, const Vec3& q, const Vec3& n_q, bool swap);

// The same for p and each of up to kPairs points with indices `others`, processed in parallel lanes.
inline constexpr std::size_t kPairs = 8;
void pair_bins(const Vec3& p, const Vec3& n_p, std::span<const Vec3> points, std::span<const Vec3> normals,
               std::span<const std::int32_t> others, bool swap, std::array<PairBins, kPairs>& bins);

}  // namespace salbench
