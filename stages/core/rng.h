// SPDX-License-Identifier: GPL-3.0-or-later
// Random numbers that depend only on (seed, stage, item): equal on any machine and for any number of threads.
// Standard libraries differ in their distributions, so the few that are needed are implemented here.
#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>

namespace salbench {

// xoshiro256**, seeded by SplitMix64 from a hash of the three names. [blackman2021]
class Rng {
 public:
  Rng(std::uint64_t seed, std::string_view stage, std::string_view item);

  std::uint64_t next() {  // uniform over 64 bits; inline, since some callers draw millions
    const std::uint64_t result = std::rotl(state_[1] * 5, 7) * 9;
    const std::uint64_t shifted = state_[1] << 17U;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= shifted;
    state_[3] = std::rotl(state_[3], 45);
    return result;
  }
  double uniform() { return static_cast<double>(next() >> 11U) * 0x1.0p-53; }  // over [0, 1), 53 bits
  std::uint64_t below(std::uint64_t bound);  // uniform over 0..bound-1, unbiased; bound > 0
  double normal();                           // mean 0, standard deviation 1

 private:
  std::uint64_t state_[4];
};

// Source of a stage's random numbers, which depend only on the run's seed and the item's name; each stage
// draws its own stream under its own name.
struct RandomSource {
  std::uint64_t seed = 0;  // seed of the run
  std::string item = {};   // name of the shape, such as "9" or "9_0"

  Rng rng(std::string_view stage) const { return Rng(seed, stage, item); }
};

}  // namespace salbench
