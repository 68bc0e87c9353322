// SPDX-License-Identifier: GPL-3.0-or-later
// Values as HDF5's filters shuffle and deflate store them, made without the library: it packs under its lock.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "io/arrays.h"
#include "io/file.h"

namespace salbench {

struct PackedChunks {
  std::vector<std::size_t> shape;  // of a chunk: the array's, but for the number of rows
  std::vector<Bytes> chunks;       // by their first row
};

// Nothing if the array is better stored as it is: deflate saves an eighth of coordinates, half of descriptors
// (single precision, mostly zeros), and most of pictures. Equal arrays give equal bytes.
std::optional<PackedChunks> packed(const Array& array);

inline constexpr unsigned kPackLevel = 1;  // of deflate: the fastest

// Inflates a chunk of `chunk_bytes` bytes, whose values take `value` bytes each, and puts those of its values
// that fit into `values`. Returns whether the chunk is sound.
bool unpack(std::span<const std::byte> packed, std::size_t value, std::size_t chunk_bytes,
            std::span<std::byte> values);

}  // namespace salbench
