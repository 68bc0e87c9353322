// SPDX-License-Identifier: GPL-3.0-or-later
// A file driver for the HDF5 library. The library's own driver for memory copies an image on its way in and
// on its way out, and the library crashes where a driver says that a disk is full (1.10.8).
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

// Bytes that stand for a file. Nothing throws, as the library is C, and nothing that is written fails: the
// first error is kept, and from there on nothing is written.
class Medium {
 public:
  Medium() = default;
  Medium(const Medium&) = delete;
  Medium& operator=(const Medium&) = delete;
  virtual ~Medium() = default;

  virtual std::uint64_t size() const = 0;
  // Gives zeros beyond the end, which the library has allocated and not written yet.
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
  explicit Disk(const std::filesystem::path& path);  // replaces what it holds
  std::uint64_t size() const override { return size_; }
  bool read(std::uint64_t at, std::span<std::byte> into) const override;
  void write(std::uint64_t at, std::span<const std::byte> from) override;
  void resize(std::uint64_t size) override;

 private:
  Descriptor file_;
  std::uint64_t size_ = 0;
};

Handle created_on(Medium& medium, hid_t creation);  // with properties of a new file

}  // namespace salbench::hdf5
