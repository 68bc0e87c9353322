// SPDX-License-Identifier: GPL-3.0-or-later
// 128-bit content digests (XXH3): of files, of arrays, of keys.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "io/arrays.h"

namespace salbench {

struct Digest {
  std::uint64_t high = 0;
  std::uint64_t low = 0;

  auto operator<=>(const Digest&) const = default;
  std::string hex() const;  // 32 digits
};

// The number that the whole text is, of 1 to 16 hexadecimal digits; nothing for any other text.
std::optional<std::uint64_t> number_from_hex(std::string_view hex);

// Absorbs fields one after the other. Texts and bytes carry their length, so that no two sequences of fields
// run into each other.
class Hasher {
 public:
  Hasher();
  Hasher(const Hasher&) = delete;
  Hasher& operator=(const Hasher&) = delete;
  ~Hasher();

  void add(std::string_view text);
  void add(std::span<const std::byte> bytes);
  void add(std::uint64_t number);
  void add(const Digest& digest);
  void add_part(std::string_view bytes);  // without a length: parts alone give xxh128 of all of them
  Digest digest() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

Digest content_digest(const Arrays& arrays);  // names, types, shapes and values; no units, no prose
Digest file_digest(std::string_view bytes);   // of all bytes of a file
Digest xxh128(std::string_view bytes);        // as `xxh128sum` prints it; keys have file_digest
std::uint64_t checksum(std::span<const std::byte> bytes);  // 64 bits, of a whole file image

}  // namespace salbench

template <>
struct std::hash<salbench::Digest> {
  std::size_t operator()(const salbench::Digest& digest) const noexcept { return digest.low; }
};
