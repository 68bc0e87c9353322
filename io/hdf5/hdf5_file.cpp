// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/hdf5/hdf5_file.h"

#include <algorithm>
#include <new>

#include <fmt/format.h>

#include "io/hdf5/hdf5_driver.h"
#include "io/hdf5/hdf5_library.h"
#include "io/shapes/text_scanner.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

using namespace hdf5;

constexpr std::string_view kSignature = "\x89HDF\r\n\x1a\n";
constexpr std::size_t kMaxRank = 8;

[[noreturn]] void refuse(std::string_view what) { throw std::runtime_error(std::string(what)); }

using Reader = ArrayValues (*)(hid_t set, std::size_t count);

template <class T>
ArrayValues read_values(hid_t set, std::size_t count) {
  std::vector<T> values(count);
  if (count > 0) must(H5Dread(set, type_of<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), "H5Dread");
  return values;
}

template <class T>
bool is_of(hid_t type) {
  return H5Tequal(type, type_of<T>()) > 0;
}

// Null for a type that this program does not write.
Reader reader_of(hid_t type) {
  return is_of<double>(type)         ? read_values<double>
         : is_of<float>(type)        ? read_values<float>
         : is_of<std::int32_t>(type) ? read_values<std::int32_t>
         : is_of<std::int64_t>(type) ? read_values<std::int64_t>
         : is_of<std::uint8_t>(type) ? read_values<std::uint8_t>
                                     : nullptr;
}

std::string read_text(hid_t attribute, hid_t type, hid_t space) {
  if (H5Tis_variable_str(type) > 0) {
    char* begin = nullptr;
    must(H5Aread(attribute, type, static_cast<void*>(&begin)), "H5Aread");
    std::string text(begin == nullptr ? "" : begin);
    must(H5Dvlen_reclaim(type, space, H5P_DEFAULT, static_cast<void*>(&begin)), "H5Dvlen_reclaim");
    return text;
  }
  std::string text(H5Tget_size(type), '\0');
  must(H5Aread(attribute, type, text.data()), "H5Aread");
  text.resize(std::min(text.size(), text.find('\0')));  // an empty text is stored as one zero byte
  return text;
}

AttributeValue read_attribute(hid_t object, const char* name) {
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose, "H5Aopen");
  const Handle type(H5Aget_type(attribute), H5Tclose, "H5Aget_type");
  const Handle space(H5Aget_space(attribute), H5Sclose, "H5Aget_space");
  const H5T_class_t kind = H5Tget_class(type);
  if (H5Sget_simple_extent_type(space) != H5S_SCALAR) refuse(in_quotes(name) + " is not a single value");
  if (kind == H5T_STRING) return read_text(attribute, type, space);
  double real = 0;
  std::int64_t integer = 0;
  const bool is_real = is_of<double>(type);
  if (!is_real && !is_of<std::int64_t>(type)) refuse(in_quotes(name) + " is neither a text nor a number");
  must(H5Aread(attribute, type, is_real ? static_cast<void*>(&real) : &integer), "H5Aread");
  return is_real ? AttributeValue(real) : AttributeValue(integer);
}

herr_t append_attribute(hid_t object, const char* name, const H5A_info_t*, void* attributes) {
  try {
    static_cast<Attributes*>(attributes)->emplace_back(name, read_attribute(object, name));
    return 0;
  } catch (const std::exception&) {
    return -1;  // no exception may cross the C library; the iteration reports the failure
  }
}

Attributes read_attributes(hid_t object) {
  Attributes attributes;
  must(H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, nullptr, append_attribute, &attributes),
       "reading its attributes");
  return attributes;
}

std::string text_beside(hid_t set, const char* name) {
  if (H5Aexists(set, name) <= 0) return {};
  AttributeValue value = read_attribute(set, name);
  auto* text = std::get_if<std::string>(&value);
  if (text == nullptr) refuse(in_quotes(name) + " is not a text");
  return std::move(*text);
}

std::vector<std::size_t> shape_of(hid_t set) {
  const Handle space(H5Dget_space(set), H5Sclose, "H5Dget_space");
  const H5S_class_t kind = H5Sget_simple_extent_type(space);
  const int rank = H5Sget_simple_extent_ndims(space);
  if ((kind != H5S_SCALAR && kind != H5S_SIMPLE) || rank < 0) refuse("it has no values");
  if (rank > static_cast<int>(kMaxRank))
    refuse(fmt::format("it has {} dimensions, expected at most {}", rank, kMaxRank));
  hsize_t extents[kMaxRank] = {};
  must(H5Sget_simple_extent_dims(space, extents, nullptr), "H5Sget_simple_extent_dims");
  return {extents, extents + rank};
}

// `file`: size of the whole file, bytes. It bounds what is allocated, but for packed values.
Array read_array(hid_t set, const std::string& name, std::uint64_t file) {
  const Handle type(H5Dget_type(set), H5Tclose, "H5Dget_type");
  const Reader read = reader_of(type);
  if (read == nullptr) refuse("data set " + in_quotes(name) + " is of a type that is never written");
  Array array{.name = name, .shape = shape_of(set), .values = {}, .unit = {}, .description = {}};
  if (array.count() / kMaxInflation > file) refuse(in_quotes(name) + " claims more values than can be");
  array.values = read(set, array.count());
  return array;
}

Handle opened_set(hid_t file, const std::string& name) {
  return {H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose, "H5Dopen"};
}

}  // namespace

bool is_hdf5(const std::filesystem::path& file) { return read_head(file, kSignature.size()) == kSignature; }

PlacedImage hdf5_image(const std::vector<NamedArray>& arrays, const Attributes& attributes) {
  constexpr unsigned kTreeK = 4, kLinksK = 2;  // groups of few links take little: half of the default
  constexpr std::uint64_t kAround = 1000;      // bytes of an array's header and links
  PlacedImage placed;
  Memory memory;
  std::uint64_t expected = kAround;
  for (const NamedArray& named : arrays) expected += bytes_of(named.array) + kAround;
  memory.bytes.reserve(expected);
  {
    const auto lock = library();
    const Handle creation = file_creation();
    must(H5Pset_sym_k(creation, kTreeK, kLinksK), "H5Pset_sym_k");
    Handle file = created_on(memory, creation);
    const Handle links = groups_between();
    for (const auto& [name, value] : attributes) write_attribute(file, name, value);
    for (const NamedArray& named : arrays) placed.pieces.push_back(write_array(file, links, named));
    must(file.close(), "H5Fclose");
  }
  if (memory.error() != 0) throw std::bad_alloc();
  placed.bytes = std::move(memory.bytes);
  return placed;
}

Bytes hdf5_image(const Hdf5Content& content) {
  std::vector<PackedArray> arrays;
  for (const Array& array : content.arrays) arrays.push_back(pack(array));
  std::vector<NamedArray> named;
  for (const PackedArray& array : arrays) named.push_back({array.name, array});
  return hdf5_image(named, content.attributes).bytes;
}

Hdf5Content hdf5_content(std::span<const std::byte> bytes, std::string_view name) try {
  Image image(bytes);
  const auto lock = library();
  const Handle file = opened_on(image);
  Hdf5Content content{{}, read_attributes(file)};
  for (const std::string& path : data_sets_in(file, bytes.size())) {
    const Handle set = opened_set(file, path);
    Array array = read_array(set, path, bytes.size());
    array.unit = text_beside(set, "unit");
    array.description = text_beside(set, "description");
    content.arrays.push_back(std::move(array));
  }
  return content;
} catch (const std::runtime_error& error) {
  throw InputError(fmt::format("{}: not a readable HDF5 file ({})", name, error.what()));
}

}  // namespace salbench
