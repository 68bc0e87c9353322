// SPDX-License-Identifier: GPL-3.0-or-later
// Writes an HDF5 file piece by piece, so that it may be larger than memory.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

#include "io/arrays.h"
#include "io/hdf5/packed_array.h"
#include "io/table.h"

namespace salbench {

// A data set of records (compound type): all cells of a column are of one type; text is of fixed length.
struct Hdf5Table {
  std::string name;
  Table table;
  std::string description;
};

// A group or data set of another file under a name in this one (external link).
struct Hdf5Link {
  std::string name;
  std::string file;    // relative to the folder of the file that holds the link
  std::string object;  // in that file: "/" or a path from there
};

// Names are paths from the root group, without a leading slash, each given once. All functions throw
// StorageError.
class Hdf5Writer {
 public:
  explicit Hdf5Writer(const std::filesystem::path& file);  // replaces what it holds
  ~Hdf5Writer();
  void attributes(const std::string& object,
                  const Attributes& attributes);  // of a group that is made, or "/"
  void array(const Array& array);
  void array(const NamedArray& array);
  void table(const Hdf5Table& table);
  void link(const Hdf5Link& link);
  void close();  // without it the file is not complete

 private:
  struct Open;
  std::unique_ptr<Open> open_;
};

}  // namespace salbench
