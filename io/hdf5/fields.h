// SPDX-License-Identifier: GPL-3.0-or-later
// Sequence of numbers, texts and digests, little-endian: written, and read with bounds checks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

#include "io/digest.h"
#include "io/file.h"
#include "stages/core/errors.h"

namespace salbench {

class FieldWriter {
 public:
  Bytes bytes = {};

  void add(std::uint64_t number) { add_bytes(std::as_bytes(std::span(&number, 1))); }
  void add(const Digest& digest) {
    add(digest.high);
    add(digest.low);
  }
  void add(std::string_view text) {
    add(std::uint64_t{text.size()});
    add_bytes(std::as_bytes(std::span(text)));
  }
  void add_bytes(std::span<const std::byte> more) { bytes.insert(bytes.end(), more.begin(), more.end()); }
};

// All members throw InputError if the bytes end too early.
class FieldReader {
 public:
  explicit FieldReader(std::span<const std::byte> bytes) : left_(bytes) {}

  std::uint64_t number() {
    std::uint64_t number = 0;
    std::memcpy(&number, take(sizeof number).data(), sizeof number);
    return number;
  }
  Digest digest() {
    const std::uint64_t high = number();
    return {high, number()};
  }
  std::string text() {
    const auto bytes = take(number());
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  void skip(std::size_t numbers) { take(numbers * sizeof(std::uint64_t)); }
  // Number of following elements, of at least 8 bytes each.
  std::uint64_t count() {
    const std::uint64_t count = number();
    if (count > left_.size() / 8) throw InputError("cut short");
    return count;
  }

 private:
  std::span<const std::byte> take(std::uint64_t size) {
    if (size > left_.size()) throw InputError("cut short");
    const auto taken = left_.first(size);
    left_ = left_.subspan(size);
    return taken;
  }

  std::span<const std::byte> left_;
};

}  // namespace salbench
