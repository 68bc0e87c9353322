// SPDX-License-Identifier: GPL-3.0-or-later
// Random numbers that several metrics read from their beginning, of one map or of all that are scored with
// the same stream. Each is drawn once, when the first one asks: what a metric reads does not depend on the
// others.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>

#include "stages/core/rng.h"

namespace salbench {

// The number in [0, 1) that Rng::uniform makes of one of Rng::next.
inline double uniform_of(std::uint64_t number) { return static_cast<double>(number >> 11U) * 0x1.0p-53; }

// An array that grows at its end. What is new has no value until it is written.
template <class T>
class Growing {
 public:
  std::size_t size() const { return size_; }
  void clear() { size_ = 0; }
  std::span<const T> first(std::size_t count) const { return {data_.get(), count}; }
  std::span<T> grow(std::size_t size) {  // to no less than it is
    if (size > room_) {
      const std::size_t room = std::max(size, 2 * room_);
      auto larger = std::make_unique_for_overwrite<T[]>(room);
      std::copy_n(data_.get(), size_, larger.get());
      data_ = std::move(larger);
      room_ = room;
    }
    const std::size_t known = std::exchange(size_, size);
    return {data_.get() + known, size - known};
  }

 private:
  std::unique_ptr<T[]> data_;
  std::size_t size_ = 0, room_ = 0;
};

// Not for several threads. What it returns is valid until the next call.
class Draws {
 public:
  explicit Draws(const Rng& rng) : rng_(rng), next_(rng) {}

  const Rng& rng() const { return rng_; }                     // at the beginning
  std::span<const std::uint64_t> numbers(std::size_t count);  // of Rng::next
  // Those of Rng::below: 0..bound-1; bound > 0.
  std::span<const std::uint32_t> below(std::uint32_t bound, std::size_t count);

 private:
  Rng rng_, next_;
  Growing<std::uint64_t> numbers_;
  std::uint32_t bound_ = 0;  // of below_
  std::size_t read_ = 0;     // numbers that below_ is made of
  Growing<std::uint32_t> below_;
};

}  // namespace salbench
