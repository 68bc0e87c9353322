// SPDX-License-Identifier: GPL-3.0-or-later
// Writes an HDF5 file incrementally, so that it may exceed memory.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

#include "io/arrays.h"
#include "io/hdf5/packed_array.h"
#include "io/table.h"

namespace salbench {

// A data set of records (compound type): each column has one type; text has fixed length.
struct Hdf5Table {
  std::string name;
  Table table;
  std::string description;
};

// External link: a name in this file for a group or data set of another.
struct Hdf5Link {
  std::string name;
  std::string file;    // relative to the folder of this file
  std::string object;  // path in that file; "/" for the root
};

// Names are unique paths from the root group, without a leading slash. All functions throw StorageError.
class Hdf5Writer {
 public:
  explicit Hdf5Writer(const std::filesystem::path& file);  // truncates an existing file
  ~Hdf5Writer();
  void attributes(const std::string& object,
                  const Attributes& attributes);  // sets attributes of a group, created if missing, or "/"
  void array(const Array& array);
  void array(const NamedArray& array);
  void table(const Hdf5Table& table);
  void link(const Hdf5Link& link);
  void close();  // required for a complete file

 private:
  struct Open;
  std::unique_ptr<Open> open_;
};

}  // namespace salbench
