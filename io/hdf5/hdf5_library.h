// SPDX-License-Identifier: GPL-3.0-or-later
// Shared by io/hdf5/hdf5_*.cpp, the only code that uses the HDF5 library (C API, 1.10).
#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#define H5_USE_110_API  // also supported by newer libraries
#include <hdf5.h>

#include "io/arrays.h"
#include "io/hdf5/packed_array.h"

namespace salbench::hdf5 {

// Held while calling the library; not recursive. A thread-safe build of the library has its own lock, but
// takes it in each call, so that contending threads hand it back and forth. Contributes to hdf5_time.
class LibraryLock {
 public:
  LibraryLock();
  LibraryLock(const LibraryLock&) = delete;
  LibraryLock& operator=(const LibraryLock&) = delete;
  ~LibraryLock();

 private:
  std::chrono::steady_clock::time_point since_;  // start of waiting, then of holding
  std::unique_lock<std::mutex> alone_;
};
inline LibraryLock library() { return {}; }

// An HDF5 identifier with its closing function. Throws if the identifier is negative: the library failed.
class Handle {
 public:
  Handle(hid_t id, herr_t (*closer)(hid_t), const char* what) : id_(id), close_(closer) {
    if (id_ < 0) throw std::runtime_error("HDF5: " + std::string(what) + " failed");
  }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&&) = delete;
  ~Handle() { close(); }
  herr_t close() { return id_ < 0 ? 0 : close_(std::exchange(id_, -1)); }
  operator hid_t() const { return id_; }  // NOLINT: that is what the C API takes

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

void must(herr_t status, const char* what);  // throws std::runtime_error

// Stored type: little-endian, as on this machine.
template <class T>
hid_t type_of() {
  if constexpr (std::is_floating_point_v<T>)
    return sizeof(T) == 8 ? H5T_IEEE_F64LE : H5T_IEEE_F32LE;
  else if constexpr (std::is_unsigned_v<T>)
    return H5T_STD_U8LE;
  else
    return sizeof(T) == 8 ? H5T_STD_I64LE : H5T_STD_I32LE;
}

Handle property_list(hid_t kind);
Handle string_type(std::size_t length);  // UTF-8; length may be H5T_VARIABLE

void write_attribute(hid_t object, const std::string& name, const AttributeValue& value);
// Returns the positions of its pieces, valid once the file has been flushed.
std::vector<FilePiece> write_array(hid_t file, hid_t links, const NamedArray& named);

Handle file_creation();   // without times, so that equal content gives equal bytes
Handle groups_between();  // creates missing groups of a path

}  // namespace salbench::hdf5
