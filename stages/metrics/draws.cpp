// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/draws.h"

namespace salbench {
namespace {

// Rng::below for one bound, the same numbers without its two divisions per draw.
class Below {
 public:
  explicit Below(std::uint64_t bound)
      : bound_(bound), reject_below_((0 - bound) % bound), inverse_(~std::uint64_t{0} / bound) {}
  std::uint64_t operator()(Rng& rng) const {
    std::uint64_t draw = rng.next();
    while (draw < reject_below_) draw = rng.next();
    // The quotient is one or two too small at most.
    __extension__ using Wide = unsigned __int128;
    std::uint64_t rest = draw - static_cast<std::uint64_t>((Wide{draw} * inverse_) >> 64U) * bound_;
    while (rest >= bound_) rest -= bound_;
    return rest;
  }

 private:
  std::uint64_t bound_, reject_below_, inverse_;
};

}  // namespace

std::span<const double> UniformDraws::first(std::size_t count) {
  drawn_.reserve(count);
  while (drawn_.size() < count) drawn_.push_back(rng_.uniform());
  return std::span(drawn_).first(count);
}

std::span<const double> ValueDraws::first(std::size_t count) {
  const Below below(map_.size() - 1);
  drawn_.reserve(count);
  while (drawn_.size() < count) drawn_.push_back(map_[1 + below(rng_)]);
  return std::span(drawn_).first(count);
}

}  // namespace salbench
