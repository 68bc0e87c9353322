// SPDX-License-Identifier: GPL-3.0-or-later
// 128-bit content digests (XXH3) of files, arrays and keys.
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

// Value of a text of 1 to 16 hexadecimal digits; nullopt for any other text.
std::optional<std::uint64_t> number_from_hex(std::string_view hex);

// Absorbs a sequence of fields. Texts and bytes are prefixed by their length, so that different sequences
// never coincide.
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
  void add_part(std::string_view bytes);  // without length prefix: parts give the xxh128 of the whole
  Digest digest() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

Digest content_digest(const Arrays& arrays);  // names, types, shapes and values; no units, no prose
Digest file_digest(std::string_view bytes);   // over all bytes
Digest xxh128(std::string_view bytes);        // as printed by `xxh128sum`; keys use file_digest
std::uint64_t checksum(std::span<const std::byte> bytes);  // 64 bits, of a file image

}  // namespace salbench

template <>
struct std::hash<salbench::Digest> {
  std::size_t operator()(const salbench::Digest& digest) const noexcept { return digest.low; }
};
