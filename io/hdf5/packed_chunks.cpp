// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/hdf5/packed_chunks.h"

#include <algorithm>
#include <memory>
#include <new>
#include <span>

#include <libdeflate.h>

namespace salbench {
namespace {

constexpr std::size_t kPackFrom = 64 * 1024;               // bytes; below, filters cost more than they save
constexpr std::size_t kChunkRows = 4096, kMaxChunks = 64;  // as many as one node of the file's index holds

// The first bytes of all values, then their second ones, and so on; zeros where the chunk has no values left.
void shuffle(std::span<const std::byte> values, std::size_t value, Bytes& chunk) {
  std::fill(chunk.begin(), chunk.end(), std::byte{});
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
    deflated.shrink_to_fit();  // it is kept until its segment is written
    return deflated;
  }

 private:
  std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> compressor_;
};

template <class T>
std::optional<PackedChunks> packed(const Array& array, const std::vector<T>& values) {
  const auto bytes = std::as_bytes(std::span(values));
  const bool packs_well = array.repetitive || std::is_same_v<T, float>;
  if (!packs_well || bytes.size() < kPackFrom || values.size() != array.count()) return {};
  PackedChunks result{array.shape, {}};
  const std::size_t rows = array.shape[0];
  result.shape[0] = std::min(rows, std::max(kChunkRows, (rows + kMaxChunks - 1) / kMaxChunks));
  const std::size_t row = bytes.size() / array.shape[0];
  const Deflate deflate;
  Bytes chunk(result.shape[0] * row);
  for (std::size_t first = 0; first < bytes.size(); first += chunk.size()) {
    shuffle(bytes.subspan(first, std::min(chunk.size(), bytes.size() - first)), sizeof(T), chunk);
    result.chunks.push_back(deflate(chunk));
  }
  return result;
}

}  // namespace

std::optional<PackedChunks> packed(const Array& array) {
  return std::visit([&](const auto& values) { return packed(array, values); }, array.values);
}

bool unpack(std::span<const std::byte> packed, std::size_t value, std::size_t chunk_bytes,
            std::span<std::byte> values) {
  const std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> decompressor(
      libdeflate_alloc_decompressor(), libdeflate_free_decompressor);
  if (!decompressor) throw std::bad_alloc();
  Bytes shuffled(chunk_bytes);
  std::size_t inflated = 0;
  if (libdeflate_zlib_decompress(decompressor.get(), packed.data(), packed.size(), shuffled.data(),
                                 chunk_bytes, &inflated) != LIBDEFLATE_SUCCESS ||
      inflated != chunk_bytes || values.size() > chunk_bytes)
    return false;
  const std::size_t stride = chunk_bytes / value;
  for (std::size_t byte = 0; byte < value; ++byte)
    for (std::size_t i = 0; i * value < values.size(); ++i)
      values[i * value + byte] = shuffled[byte * stride + i];
  return true;
}

}  // namespace salbench
