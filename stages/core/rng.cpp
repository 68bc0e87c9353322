// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/core/rng.h"

#include <cmath>
#include <numbers>

#include "stages/core/check.h"

namespace salbench {
namespace {

// FNV-1a over the name, then SplitMix64: short names that differ in one letter give unrelated streams.
std::uint64_t absorb(std::uint64_t hash, std::string_view text) {
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return (hash ^ 0xffU) * 0x100000001b3ULL;  // terminator: ("ab", "c") differs from ("a", "bc")
}

std::uint64_t split_mix(std::uint64_t& state) {
  std::uint64_t z = (state += 0x9e3779b97f4a7c15ULL);
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31U);
}

}  // namespace

Rng::Rng(std::uint64_t seed, std::string_view stage, std::string_view item) {
  std::uint64_t state = seed;
  state = split_mix(state) ^ absorb(absorb(0xcbf29ce484222325ULL, stage), item);
  for (auto& word : state_) word = split_mix(state);
}

std::uint64_t Rng::below(std::uint64_t bound) {
  CHECK_GT(bound, 0U);
  std::uint64_t draw = next();
  if (draw < bound)  // rare; values below 2^64 mod bound would be biased
    while (draw < (0 - bound) % bound) draw = next();
  return draw % bound;
}

double Rng::normal() {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
  return radius * std::cos(2.0 * std::numbers::pi * uniform());
}

}  // namespace salbench
