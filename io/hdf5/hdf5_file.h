// SPDX-License-Identifier: GPL-3.0-or-later
// HDF5 files. An artefact is a byte image, built and parsed in memory: writing it is plain, checkable file
// output, and its bytes pass a checksum before the HDF5 library sees them. Files of other programs are read
// by the Python package. Everything is safe to call from several threads.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/arrays.h"
#include "io/file.h"
#include "io/hdf5/packed_array.h"

namespace salbench {

// Names are paths from the root group, without a leading slash; missing groups are created.
struct Hdf5Content {
  Arrays arrays;
  Attributes attributes;  // of the root group
};

// The bytes of a complete HDF5 file: fixed little-endian types, UTF-8 attributes, `unit` and `description` on
// every data set, no time stamps; shuffle + deflate if arrays are large and mostly zeros. Equal content gives
// equal bytes. Throws std::runtime_error if the library fails, as it does for two arrays of the same name.
Bytes hdf5_image(const Hdf5Content& content);

// An image, and the position of each array's pieces in it.
struct PlacedImage {
  Bytes bytes;
  std::vector<std::vector<FilePiece>> pieces;  // [array]
};
PlacedImage hdf5_image(const std::vector<NamedArray>& arrays);

bool is_hdf5(const std::filesystem::path& file);  // by its first bytes; throws as read_file does

// The inverse, in the order of the names; links are not followed. Throws InputError naming `name` if the
// image is not such a file.
Hdf5Content hdf5_content(std::span<const std::byte> image, std::string_view name);

// Versions of a library: of the headers that the program was built with, and of the one that is loaded.
struct LibraryVersion {
  std::string built, loaded;
};
LibraryVersion hdf5_version();

}  // namespace salbench
