// SPDX-License-Identifier: GPL-3.0-or-later
// HDF5 files in memory, written by the library. The Python package reads files of other programs. All
// functions are thread-safe.
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
  Attributes attributes;  // on the root group
};

// Bytes of a complete HDF5 file, and the position of each array's pieces in it: fixed little-endian types,
// UTF-8 attributes, `unit` and `description` on every data set, no time stamps. Equal content gives equal
// bytes. Throws std::runtime_error if the library fails, for example for two arrays of the same name.
struct PlacedImage {
  Bytes bytes;
  std::vector<std::vector<FilePiece>> pieces;  // [array]
};
PlacedImage hdf5_image(const std::vector<NamedArray>& arrays, const Attributes& attributes = {});
Bytes hdf5_image(const Hdf5Content& content);

bool is_hdf5(const std::filesystem::path& file);  // by its first bytes; throws like read_file

// Version of a library's headers at build time, and version of the loaded library.
struct LibraryVersion {
  std::string built, loaded;
};
LibraryVersion hdf5_version();

// Seconds that all threads of the process have spent in the library, which admits one thread, and waiting
// to enter it.
struct LibraryTime {
  double held = 0, waited = 0;
};
LibraryTime hdf5_time();

}  // namespace salbench
