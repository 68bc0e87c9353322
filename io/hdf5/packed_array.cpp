// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/hdf5/packed_array.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <span>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "io/hdf5/hdf5_format.h"
#include "io/hdf5/packed_chunks.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

// Bytes of values of this shape; nothing if they are more than `most`.
std::optional<std::size_t> bytes_of(const std::vector<std::size_t>& shape, std::size_t type,
                                    std::uint64_t most) {
  std::size_t bytes = hdf5::value_bytes(type);
  for (const std::size_t extent : shape)
    if (__builtin_mul_overflow(bytes, extent, &bytes)) return {};
  return bytes <= most ? std::optional(bytes) : std::nullopt;
}

bool unpack_chunks(const PackedArray& packed, std::span<std::byte> values) {
  const std::size_t value = hdf5::value_bytes(packed.type);
  const auto chunk = bytes_of(packed.chunk, packed.type, kMaxItemBytes);
  const bool divides_rows =
      packed.chunk.size() == packed.shape.size() &&
      std::equal(packed.chunk.begin() + 1, packed.chunk.end(), packed.shape.begin() + 1);
  if (!chunk || *chunk == 0 || !divides_rows) return false;
  for (const Bytes& piece : packed.pieces) {
    const auto part = values.first(std::min(*chunk, values.size()));
    if (part.empty() || !unpack(piece, value, *chunk, part)) return false;
    values = values.subspan(part.size());
  }
  return values.empty();
}

template <std::size_t type = 0>
ArrayValues no_values(std::size_t of_type, std::size_t bytes) {
  if constexpr (type == std::variant_size_v<ArrayValues>) {
    throw InputError(fmt::format("values of an unknown type, {}", of_type));
  } else {
    using Values = std::variant_alternative_t<type, ArrayValues>;
    if (type == of_type) return Values(bytes / sizeof(typename Values::value_type));
    return no_values<type + 1>(of_type, bytes);
  }
}

}  // namespace

PackedArray pack(const Array& array) {
  PackedArray result{array.name, array.shape, array.values.index(), array.unit, array.description};
  if (auto chunks = packed(array)) {
    result.chunk = std::move(chunks->shape);
    result.pieces = std::move(chunks->chunks);
    return result;
  }
  std::visit(
      [&](const auto& values) {
        if (values.size() != array.count())
          throw std::logic_error(fmt::format("array {} has {} values for its shape of {}", array.name,
                                             values.size(), array.count()));
        const auto bytes = std::as_bytes(std::span(values));
        if (!bytes.empty()) result.pieces.emplace_back(bytes.begin(), bytes.end());
      },
      array.values);
  return result;
}

Array unpack(const PackedArray& packed) {
  const bool is_plain = packed.chunk.empty();
  const std::uint64_t most = bytes_of(packed) * (is_plain ? 1 : hdf5::kMaxInflation);
  if (packed.type >= hdf5::kTypes) throw InputError(fmt::format("array {}: unknown type", packed.name));
  const auto bytes = bytes_of(packed.shape, packed.type, most);
  if (!bytes) throw InputError(fmt::format("array {}: more values than it can have", packed.name));
  Array array{packed.name, packed.shape, no_values(packed.type, *bytes), packed.unit, packed.description};
  std::visit(
      [&](auto& values) {
        const auto into = std::as_writable_bytes(std::span(values));
        const bool is_whole = !is_plain ? unpack_chunks(packed, into)
                              : into.empty()
                                  ? packed.pieces.empty()
                                  : packed.pieces.size() == 1 && packed.pieces[0].size() == into.size();
        if (!is_whole) throw InputError(fmt::format("array {}: its pieces are not its values", packed.name));
        if (is_plain && !into.empty()) std::ranges::copy(packed.pieces[0], into.begin());
      },
      array.values);
  return array;
}

std::uint64_t bytes_of(const PackedArray& packed) {
  return std::accumulate(packed.pieces.begin(), packed.pieces.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const Bytes& piece) { return sum + piece.size(); });
}

}  // namespace salbench
