// Chi-square distances of a few histograms to all others, with the widest instructions that the machine has.
// The interface has plain pointers only, so that no code compiled for special instructions leaks into the
// rest of the program.
#pragma once

#include <cstddef>
#include <cstdint>

namespace salbench::chi2_kernel {

inline constexpr std::size_t kLanes = 16;   // histograms in a group
inline constexpr std::size_t kQueries = 4;  // histograms compared with all others in one call

// Every variant does the same operations in the same order on each pair: the same bytes on every machine.
enum class Instructions { baseline, avx2, avx512 };
bool supported(Instructions instructions);  // by this machine
Instructions widest_supported();

// distances[q * groups * 16 + j] = sum over the bins of (a - b)^2 / (a + b), a = bin of query q, b = bin of
// histogram j; bins where both are 0 add nothing. All values are finite and >= 0.
//   table      groups x bins x 16: histograms 16 g .. 16 g + 15, bin by bin
//   queries    4 x bins
//   distances  4 x (16 groups)
void distances(Instructions instructions, const float* table, std::size_t groups, std::size_t bins,
               const float* queries, float* distances);

// Writes the indices of the values <= limit, ascending, and returns how many there are; `count` is a multiple
// of 16 and `indices` has room for it.
std::size_t indices_up_to(float limit, const float* values, std::size_t count, std::int32_t* indices);

}  // namespace salbench::chi2_kernel
