// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/hdf5/hdf5_driver.h"

#include <algorithm>
#include <cerrno>
#include <new>

#include <fcntl.h>
#include <unistd.h>

namespace salbench::hdf5 {
namespace {

// The library's struct must come first.
struct OpenMedium {
  H5FD_t base = {};
  Medium* medium = nullptr;
  haddr_t allocated = 0;
};

OpenMedium& opened(H5FD_t* file) { return *reinterpret_cast<OpenMedium*>(file); }
const OpenMedium& opened(const H5FD_t* file) { return *reinterpret_cast<const OpenMedium*>(file); }

H5FD_t* open_medium(const char*, unsigned, hid_t access, haddr_t) {
  const auto* medium = static_cast<Medium* const*>(H5Pget_driver_info(access));
  if (medium == nullptr) return nullptr;
  auto* file = new (std::nothrow) OpenMedium{.medium = *medium};
  return file == nullptr ? nullptr : &file->base;
}

herr_t close_medium(H5FD_t* file) {
  delete &opened(file);
  return 0;
}

herr_t flags_of_medium(const H5FD_t*, unsigned long* flags) {
  *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
           H5FD_FEAT_AGGREGATE_SMALLDATA;
  return 0;
}

hid_t registered_driver() {
  H5FD_class_t functions = {};
#ifdef H5FD_CLASS_VERSION  // HDF5 1.14 and later
  functions.version = H5FD_CLASS_VERSION;
  functions.value = 256;  // first value that the library leaves to others
#endif
  functions.name = "salbench";
  functions.maxaddr = (haddr_t{1} << 63U) - 1;
  functions.fc_degree = H5F_CLOSE_WEAK;
  functions.fapl_size = sizeof(Medium*);  // NOLINT(bugprone-sizeof-expression): a pointer is what it keeps
  functions.open = open_medium;
  functions.close = close_medium;
  functions.query = flags_of_medium;
  functions.get_eoa = [](const H5FD_t* file, H5FD_mem_t) { return opened(file).allocated; };
  functions.set_eoa = [](H5FD_t* file, H5FD_mem_t, haddr_t allocated) -> herr_t {
    opened(file).allocated = allocated;
    return 0;
  };
  functions.get_eof = [](const H5FD_t* file, H5FD_mem_t) -> haddr_t { return opened(file).medium->size(); };
  functions.read = [](H5FD_t* file, H5FD_mem_t, hid_t, haddr_t at, size_t size, void* into) -> herr_t {
    return opened(file).medium->read(at, {static_cast<std::byte*>(into), size}) ? 0 : -1;
  };
  functions.write = [](H5FD_t* file, H5FD_mem_t, hid_t, haddr_t at, size_t size, const void* from) -> herr_t {
    opened(file).medium->write(at, {static_cast<const std::byte*>(from), size});
    return 0;
  };
  functions.truncate = [](H5FD_t* file, hid_t, hbool_t) -> herr_t {
    auto& [base, medium, allocated] = opened(file);
    if (medium->size() != allocated) medium->resize(allocated);
    return 0;
  };
  const H5FD_mem_t map[] = H5FD_FLMAP_DICHOTOMY;
  std::ranges::copy(map, functions.fl_map);
  return H5FDregister(&functions);
}

Handle access_to(Medium* medium) {
  static const hid_t driver = registered_driver();
  Handle access = property_list(H5P_FILE_ACCESS);
  must(H5Pset_driver(access, driver, static_cast<const void*>(&medium)), "H5Pset_driver");
  // The oldest file format, which HDF5 2.0 no longer writes by default: every reader opens it, and
  // move_behind knows its superblock.
  must(H5Pset_libver_bounds(access, H5F_LIBVER_EARLIEST, H5F_LIBVER_V18), "H5Pset_libver_bounds");
  return access;
}

bool read_of(std::span<const std::byte> bytes, std::uint64_t at, std::span<std::byte> into) {
  const auto there = bytes.subspan(std::min<std::uint64_t>(at, bytes.size()));
  const auto copied = std::ranges::copy(there.first(std::min(there.size(), into.size())), into.begin()).out;
  std::fill(copied, into.end(), std::byte{});
  return true;
}

}  // namespace

bool Memory::read(std::uint64_t at, std::span<std::byte> into) const { return read_of(bytes, at, into); }

void Memory::write(std::uint64_t at, std::span<const std::byte> from) {
  if (at + from.size() > bytes.size()) resize(at + from.size());
  if (error_ == 0) std::ranges::copy(from, bytes.begin() + static_cast<std::ptrdiff_t>(at));
}

void Memory::resize(std::uint64_t size) try {
  if (error_ == 0) bytes.resize(size);
} catch (const std::bad_alloc&) {
  error_ = ENOMEM;
}

Disk::Disk(const std::filesystem::path& path)
    : file_(::open(path.c_str(), O_RDWR | O_TRUNC | O_CREAT | O_CLOEXEC, 0666)) {
  if (file_.get() < 0) error_ = errno;
}

bool Disk::read(std::uint64_t at, std::span<std::byte> into) const {
  while (!into.empty()) {
    const ssize_t got = ::pread(file_.get(), into.data(), into.size(), static_cast<off_t>(at));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return false;
    if (got == 0) break;
    into = into.subspan(static_cast<std::size_t>(got));
    at += static_cast<std::uint64_t>(got);
  }
  std::ranges::fill(into, std::byte{});
  return true;
}

void Disk::write(std::uint64_t at, std::span<const std::byte> from) {
  size_ = std::max(size_, at + from.size());
  while (!from.empty() && error_ == 0) {
    const ssize_t put = ::pwrite(file_.get(), from.data(), from.size(), static_cast<off_t>(at));
    if (put < 0 && errno != EINTR) error_ = errno;
    if (put <= 0) continue;
    from = from.subspan(static_cast<std::size_t>(put));
    at += static_cast<std::uint64_t>(put);
  }
}

void Disk::resize(std::uint64_t size) {
  if (error_ == 0 && ::ftruncate(file_.get(), static_cast<off_t>(size)) != 0) error_ = errno;
  size_ = size;
}

Handle created_on(Medium& medium, hid_t creation) {
  return {H5Fcreate("salbench", H5F_ACC_TRUNC, creation, access_to(&medium)), H5Fclose, "H5Fcreate"};
}

}  // namespace salbench::hdf5
