// SPDX-License-Identifier: GPL-3.0-or-later
// Images of HDF5 files, written and read without the library, which lets one thread in at a time. Any HDF5
// reader takes them.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "io/hdf5/hdf5_file.h"

namespace salbench::hdf5 {

// As hdf5_image(). Nothing if an attribute takes more of the format than is written here: a text beyond 60
// 000 bytes.
std::optional<Bytes> written_image(const Hdf5Content& content);

// As hdf5_content(), for images of this writer and those that the library made of the same content. Nothing
// for all others, damaged ones included.
std::optional<Hdf5Content> parsed_image(std::span<const std::byte> image);

// Attributes of the file itself; its arrays are not read.
std::optional<Attributes> attributes_of_image(std::span<const std::byte> image);

// The same by the library, which knows the whole format. Both throw std::runtime_error.
Bytes image_by_library(const Hdf5Content& content);
Hdf5Content content_by_library(std::span<const std::byte> image);

}  // namespace salbench::hdf5
