// SPDX-License-Identifier: GPL-3.0-or-later
// HDF5 files. An artefact is a byte image, built and parsed in memory: writing it is plain, checkable file
// output, and its bytes pass a checksum before the HDF5 library sees them. A foreign file is read one data
// set at a time; the rest of it is never read. Everything is safe to call from several threads.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <unistd.h>

#include "io/arrays.h"
#include "io/file.h"
#include "stages/core/library_version.h"

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

// The inverse, in the order of the names; links are not followed. Throws InputError naming `name` if the
// image is not such a file.
Hdf5Content hdf5_content(std::span<const std::byte> image, std::string_view name);

// The same of an image that anybody may have written: what the program's own reader does not take, the
// library reads in a child process, whole. Throws InputError.
Hdf5Content foreign_hdf5_content(std::span<const std::byte> image, std::string_view name);

LibraryVersion hdf5_version();

// fork() at a moment when no thread is inside the library, so that the child may call all of the above.
pid_t fork_beside_hdf5();

// A file of another program.
class Hdf5File {
 public:
  // A child process reads everything first, since damaged bytes may crash the library. Throws InputError.
  explicit Hdf5File(const std::filesystem::path& path, bool in_child_first = true);
  ~Hdf5File();
  std::vector<std::string> arrays() const;  // names of the data sets of numbers, sorted. Throws InputError

  // One of them, without unit and description. Throws InputError: damaged, values in other files, or larger
  // than kMaxItemBytes or memory.
  Array read(const std::string& name) const;

 private:
  struct Open;
  std::unique_ptr<Open> open_;
};

// One value per point from the only data set of numbers in a file of another program, or from the one called
// "saliency". A child process reads it. Throws InputError, whose message begins with `name`.
ScalarField read_hdf5_values(const std::filesystem::path& path, std::string_view name);

}  // namespace salbench
