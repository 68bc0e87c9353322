// SPDX-License-Identifier: GPL-3.0-or-later
// Heads of our HDF5 files. A head lies in the file's user block, which HDF5 ignores, and contains the
// positions of each array's values. Our own files are thus read without the library: checksums are verified
// before any byte is parsed, and no lock is taken.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "io/hdf5/fields.h"
#include "io/hdf5/hdf5_file.h"

namespace salbench {

// Array without its pieces, and their positions relative to the HDF5 part.
struct ListedArray {
  PackedArray array;
  std::vector<FilePiece> pieces;
  std::uint64_t checksum = 0;  // over the pieces
};

void add(FieldWriter& out, const Attributes& attributes);
void add(FieldWriter& out, const PackedArray& array, const std::vector<FilePiece>& pieces);

// Both throw InputError for invalid fields.
Attributes attributes_in(FieldReader& in);
ListedArray array_in(FieldReader& in);

// Array with its pieces. Throws InputError if they are not those that were written.
PackedArray whole_array(ListedArray listed, const std::function<Bytes(const FilePiece&)>& read);

std::uint64_t user_block(std::uint64_t head);             // size of the smallest block for a head
void move_behind(std::uint64_t user_block, Bytes& part);  // relocates an HDF5 file behind such a block

// A complete file in memory, with attributes and arrays in its head. Equal content gives equal bytes.
Bytes image_with_head(const Hdf5Content& content);

// Inverse of image_with_head, in the original order. nullopt unless we wrote the bytes and none has changed.
std::optional<Hdf5Content> content_by_head(std::span<const std::byte> image);
std::optional<Attributes> attributes_by_head(std::span<const std::byte> image);  // does not read the arrays

}  // namespace salbench
