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

std::span<const double> Draws::uniform(std::size_t count) {
  const std::size_t known = uniform_.size();
  if (known < count) {
    uniform_.resize(count);
    Rng rng = uniform_rng_;  // one that the stores below cannot change
    for (double& drawn : std::span(uniform_).subspan(known)) drawn = rng.uniform();
    uniform_rng_ = rng;
  }
  return std::span(uniform_).first(count);
}

std::span<const std::uint32_t> Draws::below(std::uint32_t bound, std::size_t count) {
  if (bound != bound_) {
    bound_ = bound;
    below_rng_ = rng_;
    below_.clear();
  }
  const std::size_t known = below_.size();
  if (known < count) {
    const Below draw(bound);
    below_.resize(count);
    Rng rng = below_rng_;
    for (std::uint32_t& drawn : std::span(below_).subspan(known))
      drawn = static_cast<std::uint32_t>(draw(rng));
    below_rng_ = rng;
  }
  return std::span(below_).first(count);
}

std::span<const double> ValueDraws::first(std::size_t count) {
  const std::size_t known = drawn_.size();
  if (known < count) {
    const auto points = draws_.below(static_cast<std::uint32_t>(map_.size() - 1), count);
    drawn_.resize(count);
    for (std::size_t k = known; k < count; ++k) drawn_[k] = map_[points[k] + 1];
  }
  return std::span(drawn_).first(count);
}

}  // namespace salbench
