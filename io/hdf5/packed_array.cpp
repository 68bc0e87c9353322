// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/hdf5/packed_array.h"

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <new>
#include <numeric>
#include <span>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <libdeflate.h>

#include "stages/core/errors.h"

namespace salbench {
namespace {

constexpr std::size_t kPackFrom = 64 * 1024;               // bytes; filters cost more than they save below
constexpr std::size_t kChunkRows = 4096, kMaxChunks = 64;  // as many as one node of the file's index holds

// --- packing

// Writes first bytes of all values, then second bytes, and so on; zeros where the chunk exceeds the values.
void shuffle(std::span<const std::byte> values, std::size_t value, Bytes& chunk) {
  std::ranges::fill(chunk, std::byte{});
  const std::size_t stride = chunk.size() / value;
  for (std::size_t byte = 0; byte < value; ++byte)
    for (std::size_t i = 0; i * value < values.size(); ++i)
      chunk[byte * stride + i] = values[i * value + byte];
}

class Deflate {
 public:
  Deflate() : compressor_(libdeflate_alloc_compressor(kPackLevel), libdeflate_free_compressor) {
    if (!compressor_) throw std::bad_alloc();
  }
  Bytes operator()(const Bytes& bytes) const {
    Bytes deflated(libdeflate_zlib_compress_bound(compressor_.get(), bytes.size()));
    deflated.resize(libdeflate_zlib_compress(compressor_.get(), bytes.data(), bytes.size(), deflated.data(),
                                             deflated.size()));
    deflated.shrink_to_fit();  // kept until its segment is written
    return deflated;
  }

 private:
  std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> compressor_;
};

void pack_rows(PackedArray& packed, std::span<const std::byte> bytes, std::size_t value) {
  const std::size_t rows = packed.shape[0];
  packed.chunk = packed.shape;
  packed.chunk[0] = std::min(rows, std::max(kChunkRows, (rows + kMaxChunks - 1) / kMaxChunks));
  const Deflate deflate;
  for (Bytes chunk(packed.chunk[0] * (bytes.size() / rows)); !bytes.empty();) {
    const auto part = bytes.first(std::min(chunk.size(), bytes.size()));
    shuffle(part, value, chunk);
    packed.pieces.push_back(deflate(chunk));
    bytes = bytes.subspan(part.size());
  }
}

// --- unpacking

std::size_t value_bytes(std::size_t type) {
  constexpr std::array<std::size_t, std::variant_size_v<ArrayValues>> kBytes = {8, 4, 4, 8, 1};
  return kBytes.at(type);
}

// Bytes of values of this shape; nullopt for more than `most`.
std::optional<std::size_t> bytes_of(const std::vector<std::size_t>& shape, std::size_t type,
                                    std::uint64_t most) {
  std::size_t bytes = value_bytes(type);
  for (const std::size_t extent : shape)
    if (__builtin_mul_overflow(bytes, extent, &bytes)) return {};
  return bytes <= most ? std::optional(bytes) : std::nullopt;
}

class Inflate {
 public:
  explicit Inflate(std::size_t chunk)
      : decompressor_(libdeflate_alloc_decompressor(), libdeflate_free_decompressor), shuffled_(chunk) {
    if (!decompressor_) throw std::bad_alloc();
  }

  // Unpacks the first values of a chunk into `values`. True if the chunk is valid.
  bool operator()(const Bytes& packed, std::size_t value, std::span<std::byte> values) {
    std::size_t inflated = 0;
    if (libdeflate_zlib_decompress(decompressor_.get(), packed.data(), packed.size(), shuffled_.data(),
                                   shuffled_.size(), &inflated) != LIBDEFLATE_SUCCESS ||
        inflated != shuffled_.size())
      return false;
    const std::size_t stride = shuffled_.size() / value;
    for (std::size_t byte = 0; byte < value; ++byte)
      for (std::size_t i = 0; i * value < values.size(); ++i)
        values[i * value + byte] = shuffled_[byte * stride + i];
    return true;
  }

 private:
  std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> decompressor_;
  Bytes shuffled_;
};

// most: largest size that the pieces can unpack to, which bounds the size of a chunk.
bool unpack_rows(const PackedArray& packed, std::span<std::byte> values, std::uint64_t most) {
  const auto chunk = bytes_of(packed.chunk, packed.type, most);
  const bool divides_rows =
      packed.chunk.size() == packed.shape.size() &&
      std::equal(packed.chunk.begin() + 1, packed.chunk.end(), packed.shape.begin() + 1);
  if (!chunk || *chunk == 0 || !divides_rows) return false;
  Inflate inflate(*chunk);
  for (const Bytes& piece : packed.pieces) {
    const auto part = values.first(std::min(*chunk, values.size()));
    if (part.empty() || !inflate(piece, value_bytes(packed.type), part)) return false;
    values = values.subspan(part.size());
  }
  return values.empty();
}

bool copy_rows(const PackedArray& packed, std::span<std::byte> values) {
  if (values.empty()) return packed.pieces.empty();
  if (packed.pieces.size() != 1 || packed.pieces[0].size() != values.size()) return false;
  std::ranges::copy(packed.pieces[0], values.begin());
  return true;
}

template <std::size_t type = 0>
ArrayValues no_values(std::size_t of_type, std::size_t bytes) {
  if constexpr (type + 1 < std::variant_size_v<ArrayValues>)
    if (type != of_type) return no_values<type + 1>(of_type, bytes);
  using Values = std::variant_alternative_t<type, ArrayValues>;
  return Values(bytes / sizeof(typename Values::value_type));
}

}  // namespace

PackedArray pack(const Array& array) {
  PackedArray result{array.name, array.shape, array.values.index(), array.unit, array.description};
  std::visit(
      [&]<class T>(const std::vector<T>& values) {
        if (values.size() != array.count())
          throw std::logic_error(fmt::format("array {} has {} values for its shape of {}", array.name,
                                             values.size(), array.count()));
        const auto bytes = std::as_bytes(std::span(values));
        const bool packs_well = array.repetitive || std::is_same_v<T, float>;
        if (packs_well && bytes.size() >= kPackFrom)
          pack_rows(result, bytes, sizeof(T));
        else if (!bytes.empty())
          result.pieces.emplace_back(bytes.begin(), bytes.end());
      },
      array.values);
  return result;
}

Array unpack(const PackedArray& packed) {
  const bool is_plain = packed.chunk.empty();
  const std::uint64_t most = bytes_of(packed) * (is_plain ? 1 : kMaxInflation);
  if (packed.type >= std::variant_size_v<ArrayValues>)
    throw InputError(fmt::format("array {}: unknown type", packed.name));
  const auto bytes = bytes_of(packed.shape, packed.type, most);
  if (!bytes) throw InputError(fmt::format("array {}: more values than it can have", packed.name));
  Array array{packed.name, packed.shape, no_values(packed.type, *bytes), packed.unit, packed.description};
  std::visit(
      [&](auto& values) {
        const auto into = std::as_writable_bytes(std::span(values));
        if (!(is_plain ? copy_rows(packed, into) : unpack_rows(packed, into, most)))
          throw InputError(fmt::format("array {}: its pieces are not its values", packed.name));
      },
      array.values);
  return array;
}

std::uint64_t bytes_of(const PackedArray& packed) {
  return std::accumulate(packed.pieces.begin(), packed.pieces.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const Bytes& piece) { return sum + piece.size(); });
}

}  // namespace salbench
