// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/digest.h"

#include <map>
#include <vector>

#include <fmt/format.h>
#include <xxhash.h>

#include "stages/core/number.h"

namespace salbench {

std::string Digest::hex() const { return fmt::format("{:016x}{:016x}", high, low); }

std::optional<std::uint64_t> number_from_hex(std::string_view hex) {
  return number_in<std::uint64_t>(hex, 16);
}

struct Hasher::State {
  XXH3_state_t* xxh = XXH3_createState();
  ~State() { XXH3_freeState(xxh); }
};

Hasher::Hasher() : state_(std::make_unique<State>()) { XXH3_128bits_reset(state_->xxh); }
Hasher::~Hasher() = default;

void Hasher::add(std::uint64_t number) {
  XXH3_128bits_update(state_->xxh, &number, sizeof number);  // assumes little-endian (x86-64)
}

void Hasher::add(std::span<const std::byte> bytes) {
  add(std::uint64_t{bytes.size()});
  XXH3_128bits_update(state_->xxh, bytes.data(), bytes.size());
}

void Hasher::add(std::string_view text) { add(std::as_bytes(std::span(text))); }

void Hasher::add(const Digest& digest) {
  add(digest.high);
  add(digest.low);
}

void Hasher::add_part(std::string_view bytes) {
  XXH3_128bits_update(state_->xxh, bytes.data(), bytes.size());
}

Digest Hasher::digest() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(state_->xxh);
  return {hash.high64, hash.low64};
}

Digest content_digest(const Arrays& arrays) {
  std::map<std::string_view, const Array*> by_name;  // sorted: files list arrays by name, stages in any order
  for (const Array& array : arrays) by_name.emplace(array.name, &array);
  Hasher hasher;
  for (const auto& [name, array] : by_name) {
    hasher.add(name);
    hasher.add(std::uint64_t{array->shape.size()});
    for (const std::size_t extent : array->shape) hasher.add(std::uint64_t{extent});
    hasher.add(std::uint64_t{array->values.index()});
    std::visit([&](const auto& values) { hasher.add(std::as_bytes(std::span(values))); }, array->values);
  }
  return hasher.digest();
}

Digest file_digest(std::string_view bytes) {
  constexpr std::size_t kBlock = 1U << 20U;  // each block is one field: another size changes every digest
  Hasher hasher;
  for (; bytes.size() >= kBlock; bytes.remove_prefix(kBlock)) hasher.add(bytes.substr(0, kBlock));
  hasher.add(bytes);
  return hasher.digest();
}

Digest xxh128(std::string_view bytes) {
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  return {hash.high64, hash.low64};
}

std::uint64_t checksum(std::span<const std::byte> bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

}  // namespace salbench
