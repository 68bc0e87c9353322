// HDF5 files as byte images. A file is built and parsed in memory, so that writing it is plain, checkable
// file input and output, and no byte that has not passed a checksum ever reaches the HDF5 library.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "io/arrays.h"

namespace salbench {

struct Hdf5Content {
  Arrays arrays;
  Attributes attributes;  // of the root group
};

using Bytes = std::vector<std::byte>;

// The bytes of a complete HDF5 file: fixed little-endian types, UTF-8 attributes, `unit` and `description` on
// every data set, no time stamps; shuffle + deflate where arrays are large and mostly zeros. Equal content
// gives equal bytes. Safe to call from several threads. Throws std::runtime_error where the library fails.
Bytes hdf5_image(const Hdf5Content& content);

// The inverse. Throws InputError naming `name` where the image is not such a file.
Hdf5Content hdf5_content(std::span<const std::byte> image, std::string_view name);

}  // namespace salbench
