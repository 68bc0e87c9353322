// SPDX-License-Identifier: GPL-3.0-or-later
// Inner loops of the chi-square search, for the widest instructions of the machine. The interface has only
// plain pointers, so that no code compiled for special instructions leaks into the rest of the program.
#pragma once

#include <cstddef>
#include <cstdint>

namespace salbench::chi2_kernel {

inline constexpr std::size_t kLanes = 16;  // histograms, or boxes, in a group
constexpr std::size_t groups_of(std::size_t n) { return (n + kLanes - 1) / kLanes; }
inline constexpr std::size_t kUnit = 4;      // groups that share their empty bins
inline constexpr std::size_t kMaxBins = 64;  // limit of a histogram: one bit per bin

// Weight of a pair by its distance d in space, 0 <= d <= 2.
enum class Weight {
  near,  // 1 / (1 + d)
  far    // log(1 + d)
};
// chi2 * weight of the distance, rounded to a multiple of grid * 2^-23; `grid` is a power of two. A sum of
// such terms in double precision is exact as long as it is below grid * 2^30, whatever their order.
float term_of(Weight weight, float grid, float chi2, float distance);

// Added to a + b: turns 0 / 0 into 0, and is lost in any other sum. Far above the denormal numbers, which are
// slow.
inline constexpr float kTiny = 1e-18F;
// (a - b)^2 / (a + b) for b = 0, with the bits that the kernels compute.
constexpr float term_alone(float a) { return a * a / (a + kTiny); }

// Histograms in units of kUnit groups. Bins that are 0 in a whole unit, as most are, have no values there.
struct PackedTable {
  const float* values;          // unit by unit, in a unit group by group: filled bins x 16
  const float* alone;           // at the same positions: term_alone() of the values
  const std::uint64_t* filled;  // per unit: bit i is set if it has values of bin i
  const std::size_t* starts;    // per unit: index of its first value
};

struct PackedQuery {
  const float* values = nullptr;  // bins
  std::uint64_t filled = 0;       // bit i is set if bin i is not 0
  float alone[kMaxBins] = {};     // term_alone() of the values
};

// All values below are finite and >= 0, except the padding of a last group.
struct Kernel {
  const char* instructions;  // name in Highway: "SSE2", "AVX2", "AVX3" (AVX-512), "NEON" ...

  // distances[16 g + lane] = sum over the bins of (a - b)^2 / (a + b), a = bin of the query, b = bin of the
  // lane-th histogram of the group groups[g]; bins where both are 0 add nothing. Groups of a unit that follow
  // each other are measured together.
  //   distances  16 count
  void (*distances)(const PackedTable& table, const PackedQuery& query, const std::int32_t* groups,
                    std::size_t count, float* distances);

  // The same to the nearest possible histogram of each box: no histogram in it is nearer, up to rounding.
  //   boxes      groups x bins x 2 x 16: least and greatest value of a bin in the boxes of a group
  void (*bounds)(const float* boxes, std::size_t bins, const float* query, const std::int32_t* groups,
                 std::size_t count, float* bounds);

  // Number of values <= limit; `count` is a multiple of 16.
  std::size_t (*count_up_to)(float limit, const float* values, std::size_t count);

  // Writes the indices of the values above `low` and up to `high`, ascending, and returns their number;
  // `count` is a multiple of 16 and `places` has room for it.
  std::size_t (*places_between)(float low, float high, const float* values, std::size_t count,
                                std::int32_t* places);

  // Sum of the terms of the histograms of the groups whose chi2 is <= limit.
  //   chi2    16 count
  //   places  groups x 3 x 16: x, y and z
  //   from    x, y, z
  double (*weighted_sum)(Weight weight, float grid, float limit, const float* chi2, const float* places,
                         const float* from, const std::int32_t* groups, std::size_t count);
};
// All instruction sets apply the same operations in the same order to each pair: equal bytes on every
// machine.
const Kernel& kernel();  // widest of this machine, or as restricted by hwy::SetSupportedTargetsForTest()

}  // namespace salbench::chi2_kernel
