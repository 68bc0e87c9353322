// SPDX-License-Identifier: GPL-3.0-or-later
// HDF5 files in memory, written by the library. Files of other programs are read by the Python package.
// Everything is safe to call from several threads.
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

// The bytes of a complete HDF5 file, and the position in it of each array's pieces: fixed little-endian
// types, UTF-8 attributes, `unit` and `description` on every data set, no time stamps. Equal content gives
// equal bytes. Throws std::runtime_error if the library fails, as it does for two arrays of the same name.
struct PlacedImage {
  Bytes bytes;
  std::vector<std::vector<FilePiece>> pieces;  // [array]
};
PlacedImage hdf5_image(const std::vector<NamedArray>& arrays, const Attributes& attributes = {});
Bytes hdf5_image(const Hdf5Content& content);

bool is_hdf5(const std::filesystem::path& file);  // by its first bytes; throws as read_file does

// Versions of a library: of the headers that the program was built with, and of the one that is loaded.
struct LibraryVersion {
  std::string built, loaded;
};
LibraryVersion hdf5_version();

// Seconds of the process's threads until now: in the library, where one is at a time, and before it.
struct LibraryTime {
  double held = 0, waited = 0;
};
LibraryTime hdf5_time();

}  // namespace salbench
