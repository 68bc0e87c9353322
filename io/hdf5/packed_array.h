// SPDX-License-Identifier: GPL-3.0-or-later
// An array as it lies in an HDF5 file: its values in pieces, packed where that pays. Files are written from
// such arrays and read into them; packing and unpacking need no library, which packs under its lock.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "io/arrays.h"
#include "io/file.h"

namespace salbench {

struct PackedArray {
  std::string name;
  std::vector<std::size_t> shape;
  std::size_t type = 0;  // the alternative of ArrayValues
  std::string unit, description;
  std::vector<std::size_t> chunk = {};  // shape of a packed piece; empty: one piece, the values as they are
  std::vector<Bytes> pieces = {};       // by their first rows; none where there are no values
};

// Under a path of its own in a file.
struct NamedArray {
  std::string name;
  const PackedArray& array;
};

struct FilePiece {
  std::uint64_t at = 0, bytes = 0;
};

inline constexpr unsigned kPackLevel = 1;             // of deflate: the fastest
inline constexpr std::uint64_t kMaxInflation = 1032;  // the most that deflate can do

// Packed where that pays: deflate saves an eighth of coordinates, half of descriptors (single precision,
// mostly zeros), and most of pictures. Equal arrays give equal bytes. Throws std::logic_error where values
// and shape do not agree.
PackedArray pack(const Array& array);

// Throws InputError where the pieces do not give the values.
Array unpack(const PackedArray& packed);

std::uint64_t bytes_of(const PackedArray& packed);  // of its pieces

}  // namespace salbench
