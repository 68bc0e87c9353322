// SPDX-License-Identifier: GPL-3.0-or-later
// An array as stored in an HDF5 file: values in pieces, compressed if worthwhile. Files are written from such
// arrays and read into them; compression does not use the library, which would hold its lock meanwhile.
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
  std::size_t type = 0;  // index of the alternative of ArrayValues
  std::string unit, description;
  std::vector<std::size_t> chunk = {};  // shape of a compressed piece; empty: one uncompressed piece
  std::vector<Bytes> pieces = {};       // ordered by first row; empty without values
};

// An array with its path in a file.
struct NamedArray {
  std::string name;
  const PackedArray& array;
};

struct FilePiece {
  std::uint64_t at = 0, bytes = 0;
};

inline constexpr unsigned kPackLevel = 1;             // fastest level of deflate
inline constexpr std::uint64_t kMaxInflation = 1032;  // upper limit of deflate

// Compresses if worthwhile: deflate saves an eighth of coordinates, half of descriptors (single precision,
// mostly zeros), and most of pictures. Equal arrays give equal bytes. Throws std::logic_error if values and
// shape disagree.
PackedArray pack(const Array& array);

// Throws InputError if the pieces do not match the shape.
Array unpack(const PackedArray& packed);

std::uint64_t bytes_of(const PackedArray& packed);  // total size of the pieces

}  // namespace salbench
