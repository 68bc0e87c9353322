// SPDX-License-Identifier: GPL-3.0-or-later
// Heads of our HDF5 files. A head stands in the file's user block, where HDF5 looks at nothing, and says
// where the values of each array lie. So what we wrote is read without the library: no byte is parsed before
// a checksum has vouched for it, and no lock is taken.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "io/hdf5/fields.h"
#include "io/hdf5/hdf5_file.h"

namespace salbench {

// Without its pieces, and where they lie, counted from the begin of the HDF5 part.
struct ListedArray {
  PackedArray array;
  std::vector<FilePiece> pieces;
  std::uint64_t checksum = 0;  // of the pieces
};

void add(FieldWriter& out, const Attributes& attributes);
void add(FieldWriter& out, const PackedArray& array, const std::vector<FilePiece>& pieces);

// These throw InputError where the fields are no such thing.
Attributes attributes_in(FieldReader& in);
ListedArray array_in(FieldReader& in);

// With its pieces. Throws InputError where they are not those that were written.
PackedArray whole_array(ListedArray listed, const std::function<Bytes(const FilePiece&)>& read);

std::uint64_t user_block(std::uint64_t head);             // bytes of the least one that takes such a head
void move_behind(std::uint64_t user_block, Bytes& part);  // an HDF5 file, as the part behind such a block

// A whole file in memory, with attributes and arrays in its head. Equal content gives equal bytes.
Bytes image_with_head(const Hdf5Content& content);

// The inverse, in the order that it was given in. Nothing where we did not write the bytes, every one of
// them.
std::optional<Hdf5Content> content_by_head(std::span<const std::byte> image);
std::optional<Attributes> attributes_by_head(std::span<const std::byte> image);  // its arrays are not read

}  // namespace salbench
