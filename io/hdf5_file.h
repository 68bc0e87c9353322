// HDF5 files. An artefact is a byte image, built and parsed in memory: writing it is plain, checkable file
// output, and its bytes pass a checksum before the HDF5 library sees them. A foreign file is read one data
// set at a time, an export written one. What a file holds beside that is never read. Everything is safe to
// call from several threads.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/arrays.h"
#include "io/file.h"
#include "io/table.h"

namespace salbench {

// Names are paths from the root group, without a slash in front; the groups on them are made.
struct Hdf5Content {
  Arrays arrays;
  Attributes attributes;  // of the root group
};

// The bytes of a complete HDF5 file: fixed little-endian types, UTF-8 attributes, `unit` and `description` on
// every data set, no time stamps; shuffle + deflate where arrays are large and mostly zeros. Equal content
// gives equal bytes. Throws std::runtime_error where the library fails, as it does for two arrays of one
// name.
Bytes hdf5_image(const Hdf5Content& content);

// The inverse, in the order of the names; links are not followed. Throws InputError naming `name` where the
// image is not such a file.
Hdf5Content hdf5_content(std::span<const std::byte> image, std::string_view name);

// A file of another program.
class Hdf5File {
 public:
  explicit Hdf5File(const std::filesystem::path& path);  // throws InputError
  ~Hdf5File();
  std::vector<std::string> arrays() const;  // names of the data sets of numbers, sorted. Throws InputError

  // One of them, without unit and description. Throws InputError: damaged, values in other files, no room in
  // memory for what it claims.
  Array read(const std::string& name) const;

 private:
  struct Open;
  std::unique_ptr<Open> open_;
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

// Writes a file piece by piece. Names as above, each given once; all functions throw StorageError.
class Hdf5Writer {
 public:
  explicit Hdf5Writer(const std::filesystem::path& file);  // replaces what it holds
  ~Hdf5Writer();
  void attributes(const std::string& object,
                  const Attributes& attributes);  // of a group that is made, or "/"
  void array(const Array& array);
  void table(const Hdf5Table& table);
  void link(const Hdf5Link& link);
  void copy(const std::string& group, std::span<const std::byte> image);  // its data sets, packed as they are
  void close();  // without it the file is not complete

 private:
  struct Open;
  std::unique_ptr<Open> open_;
};

}  // namespace salbench
