// HDF5 files as byte images. A file is built and parsed in memory, so that writing it is plain, checkable
// file input and output, and no byte that has not passed a checksum ever reaches the HDF5 library.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/arrays.h"
#include "io/file.h"
#include "io/table.h"

namespace salbench {

// Of a group, or of an array or table beside its unit and description.
struct Hdf5Attributes {
  std::string object;  // "52/fpfh"; a group that nothing else implies is made
  Attributes attributes;
};

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

// Names are paths from the root group, without a slash in front; the groups on them are made.
struct Hdf5Content {
  Arrays arrays;
  Attributes attributes;  // of the root group
  std::vector<Hdf5Attributes> attributes_of = {};
  std::vector<Hdf5Table> tables = {};
  std::vector<Hdf5Link> links = {};
};

// The bytes of a complete HDF5 file: fixed little-endian types, UTF-8 attributes, `unit` and `description` on
// every data set, no time stamps; shuffle + deflate where arrays are large and mostly zeros. Equal content
// gives equal bytes. Safe to call from several threads. Throws std::runtime_error where the library fails, as
// it does for two things of one name.
Bytes hdf5_image(const Hdf5Content& content);

// The inverse, in the order of the names; links are not followed. Throws InputError naming `name` where the
// image is not such a file.
Hdf5Content hdf5_content(std::span<const std::byte> image, std::string_view name);

}  // namespace salbench
