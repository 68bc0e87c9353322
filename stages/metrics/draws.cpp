// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/metrics/draws.h"

namespace salbench {
namespace {

// Rng::below for one bound, without its two divisions per draw.
class Below {
 public:
  explicit Below(std::uint64_t bound)
      : bound_(bound), reject_below_((0 - bound) % bound), inverse_(~std::uint64_t{0} / bound) {}
  bool rejects(std::uint64_t number) const { return number < reject_below_; }
  std::uint64_t operator()(std::uint64_t number) const {
    // The quotient is too small by one at most, and about every third time: what branches there guesses
    // wrong.
    __extension__ using Wide = unsigned __int128;
    const std::uint64_t rest = number - static_cast<std::uint64_t>((Wide{number} * inverse_) >> 64U) * bound_;
    return rest < bound_ ? rest : rest - bound_;
  }

 private:
  std::uint64_t bound_, reject_below_, inverse_;
};

}  // namespace

std::span<const std::uint64_t> Draws::numbers(std::size_t count) {
  if (numbers_.size() < count) {
    Rng rng = next_;  // one that the stores below cannot change
    for (std::uint64_t& number : numbers_.grow(count)) number = rng.next();
    next_ = rng;
  }
  return numbers_.first(count);
}

std::span<const std::uint32_t> Draws::below(std::uint32_t bound, std::size_t count) {
  if (bound != bound_) {
    bound_ = bound;
    read_ = 0;
    below_.clear();
  }
  if (below_.size() < count) {
    const Below below(bound);
    std::size_t read = read_;
    std::span<const std::uint64_t> from = numbers(read + count - below_.size());
    const auto next = [&] {
      if (read == from.size()) from = numbers(read + 1);  // some were rejected
      return from[read++];
    };
    for (std::uint32_t& drawn : below_.grow(count)) {
      std::uint64_t number = next();
      while (below.rejects(number)) number = next();
      drawn = static_cast<std::uint32_t>(below(number));
    }
    read_ = read;
  }
  return below_.first(count);
}

}  // namespace salbench
