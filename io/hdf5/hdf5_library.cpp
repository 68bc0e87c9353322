// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/hdf5/hdf5_library.h"

#include <algorithm>
#include <atomic>
#include <string_view>

#include <fmt/format.h>

#include "io/hdf5/hdf5_file.h"

namespace salbench::hdf5 {
namespace {

constexpr std::size_t kLongText = 60'000;  // bytes; an object header holds at most 64 KB of attributes

// Identifier with the program's lifetime: most calls use the same few.
hid_t lasting(hid_t id) {
  must(id < 0 ? -1 : 0, "making a description");
  return id;
}

hid_t scalar_space() {
  static const hid_t space = lasting(H5Screate(H5S_SCALAR));
  return space;
}

void write_attribute(hid_t object, const std::string& name, hid_t type, const void* value) {
  const Handle attribute(H5Acreate2(object, name.c_str(), type, scalar_space(), H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose, "H5Acreate");
  must(H5Awrite(attribute, type, value), "H5Awrite");
}

hid_t type_at(std::size_t alternative) {
  const hid_t types[] = {type_of<double>(), type_of<float>(), type_of<std::int32_t>(),
                         type_of<std::int64_t>(), type_of<std::uint8_t>()};
  static_assert(std::size(types) == std::variant_size_v<ArrayValues>);
  return types[alternative];
}

hid_t plain_set() {
  static const hid_t properties = [] {
    const hid_t made = lasting(H5Pcreate(H5P_DATASET_CREATE));
    must(H5Pset_obj_track_times(made, false), "H5Pset_obj_track_times");
    return made;
  }();
  return properties;
}

Handle packed_set(const PackedArray& array) {
  Handle properties(H5Pcopy(plain_set()), H5Pclose, "H5Pcopy");
  const std::vector<hsize_t> chunk(array.chunk.begin(), array.chunk.end());
  must(H5Pset_chunk(properties, static_cast<int>(chunk.size()), chunk.data()), "H5Pset_chunk");
  must(H5Pset_shuffle(properties), "H5Pset_shuffle");
  must(H5Pset_deflate(properties, kPackLevel), "H5Pset_deflate");
  return properties;
}

Handle created_set(hid_t file, hid_t links, const std::string& name, const PackedArray& array) {
  const std::vector<hsize_t> shape(array.shape.begin(), array.shape.end());
  const Handle space(shape.empty() ? H5Scopy(scalar_space())
                                   : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
                     H5Sclose, "H5Screate");
  const auto create = [&](hid_t properties) {
    return Handle(H5Dcreate2(file, name.c_str(), type_at(array.type), space, links, properties, H5P_DEFAULT),
                  H5Dclose, "H5Dcreate");
  };
  return array.chunk.empty() ? create(plain_set()) : create(packed_set(array));
}

std::vector<FilePiece> write_pieces(hid_t set, hid_t type, const PackedArray& array) {
  if (array.pieces.empty()) return {};
  if (array.chunk.empty()) {
    must(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, array.pieces[0].data()), "H5Dwrite");
    return {{H5Dget_offset(set), array.pieces[0].size()}};
  }
  std::vector<FilePiece> written;
  std::vector<hsize_t> at(array.chunk.size(), 0);
  for (const Bytes& piece : array.pieces) {
    must(H5Dwrite_chunk(set, H5P_DEFAULT, 0, at.data(), piece.size(), piece.data()), "H5Dwrite_chunk");
    haddr_t address = 0;
    must(H5Dget_chunk_info_by_coord(set, at.data(), nullptr, &address, nullptr), "H5Dget_chunk_info");
    written.push_back({address, piece.size()});
    at[0] += array.chunk[0];
  }
  return written;
}

std::mutex& entrance() {
  static std::mutex the_entrance;
  return the_entrance;
}

using Clock = std::chrono::steady_clock;
std::atomic<Clock::rep> held = 0, waited = 0;  // over all threads

// Adds the time since `then`, and returns the current time.
Clock::time_point add_since(Clock::time_point then, std::atomic<Clock::rep>& sum) {
  const Clock::time_point now = Clock::now();
  sum += (now - then).count();
  return now;
}

double seconds(const std::atomic<Clock::rep>& sum) {
  return std::chrono::duration<double>(Clock::duration(sum.load())).count();
}

}  // namespace

// Disables the library's clean-up at exit, which loops forever if a disk is full; all files are closed by
// then.
LibraryLock::LibraryLock() : since_(Clock::now()), alone_(entrance()) {
  since_ = add_since(since_, waited);
  static const bool leaves = H5dont_atexit() >= 0;
  static_cast<void>(leaves);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // per thread: failures are exceptions, not text on stderr
}

LibraryLock::~LibraryLock() { add_since(since_, held); }

void must(herr_t status, const char* what) {
  if (status < 0) throw std::runtime_error(fmt::format("HDF5: {} failed", what));
}

Handle property_list(hid_t kind) { return {H5Pcreate(kind), H5Pclose, "H5Pcreate"}; }

Handle string_type(std::size_t length) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "H5Tcopy");
  must(H5Tset_size(type, std::max<std::size_t>(length, 1)), "H5Tset_size");
  must(H5Tset_cset(type, H5T_CSET_UTF8), "H5Tset_cset");
  if (length != H5T_VARIABLE) must(H5Tset_strpad(type, H5T_STR_NULLPAD), "H5Tset_strpad");
  return type;
}

void write_attribute(hid_t object, const std::string& name, const AttributeValue& value) {
  if (const auto* text = std::get_if<std::string>(&value)) {
    const bool on_heap = text->size() > kLongText;
    const char* begin = text->c_str();
    const Handle type = string_type(on_heap ? H5T_VARIABLE : text->size());
    write_attribute(object, name, type, on_heap ? static_cast<const void*>(&begin) : begin);
  } else if (const auto* real = std::get_if<double>(&value)) {
    write_attribute(object, name, type_of<double>(), real);
  } else {
    write_attribute(object, name, type_of<std::int64_t>(), &std::get<std::int64_t>(value));
  }
}

std::vector<FilePiece> write_array(hid_t file, hid_t links, const NamedArray& named) {
  const Handle set = created_set(file, links, named.name, named.array);
  auto pieces = write_pieces(set, type_at(named.array.type), named.array);
  write_attribute(set, "unit", named.array.unit);
  write_attribute(set, "description", named.array.description);
  return pieces;
}

Handle file_creation() {
  Handle creation = property_list(H5P_FILE_CREATE);
  must(H5Pset_obj_track_times(creation, false), "H5Pset_obj_track_times");
  return creation;
}

Handle groups_between() {
  Handle links = property_list(H5P_LINK_CREATE);
  must(H5Pset_create_intermediate_group(links, 1), "H5Pset_create_intermediate_group");
  return links;
}

}  // namespace salbench::hdf5

namespace salbench {

LibraryTime hdf5_time() { return {hdf5::seconds(hdf5::held), hdf5::seconds(hdf5::waited)}; }

LibraryVersion hdf5_version() {
  const auto guard = hdf5::library();
  unsigned major = 0, minor = 0, release = 0;
  hdf5::must(H5get_libversion(&major, &minor, &release), "H5get_libversion");
  return {fmt::format("{}.{}.{}", H5_VERS_MAJOR, H5_VERS_MINOR, H5_VERS_RELEASE),
          fmt::format("{}.{}.{}", major, minor, release)};
}

}  // namespace salbench
