// SPDX-License-Identifier: GPL-3.0-or-later
// File driver for the HDF5 library. The library's own in-memory driver copies an image at opening and at
// closing, and the library (1.10.8) crashes if a driver reports a full disk.
#pragma once

#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <span>
#include <utility>

#include "io/descriptor.h"
#include "io/file.h"
#include "io/hdf5/hdf5_library.h"

namespace salbench::hdf5 {

// Bytes that represent a file. Nothing throws, as the library is C, and writes never report failure: the
// first error is kept, and later writes are ignored.
class Medium {
 public:
  Medium() = default;
  Medium(const Medium&) = delete;
  Medium& operator=(const Medium&) = delete;
  virtual ~Medium() = default;

  virtual std::uint64_t size() const = 0;
  // Returns zeros beyond the end, for space that the library allocated but has not written.
  virtual bool read(std::uint64_t at, std::span<std::byte> into) const = 0;
  virtual void write(std::uint64_t at, std::span<const std::byte> from) = 0;
  virtual void resize(std::uint64_t size) = 0;

  int error() const { return error_; }  // errno of the first failure, or 0

 protected:
  int error_ = 0;
};

class Memory final : public Medium {
 public:
  Bytes bytes = {};

  std::uint64_t size() const override { return bytes.size(); }
  bool read(std::uint64_t at, std::span<std::byte> into) const override;
  void write(std::uint64_t at, std::span<const std::byte> from) override;
  void resize(std::uint64_t size) override;
};

class Disk final : public Medium {
 public:
  explicit Disk(const std::filesystem::path& path);  // truncates an existing file
  std::uint64_t size() const override { return size_; }
  bool read(std::uint64_t at, std::span<std::byte> into) const override;
  void write(std::uint64_t at, std::span<const std::byte> from) override;
  void resize(std::uint64_t size) override;

 private:
  Descriptor file_;
  std::uint64_t size_ = 0;
};

Handle created_on(Medium& medium, hid_t creation);  // with creation properties

}  // namespace salbench::hdf5
