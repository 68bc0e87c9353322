// SPDX-License-Identifier: GPL-3.0-or-later
// The core driver keeps an artefact in memory; its image is taken with H5Fget_file_image, in the library's
// earliest format: the only one of which it takes a correct image.
//
// The library converts and fills whatever a data space declares. So class, size and space of a data set or
// attribute are checked before a value is read, and the declared size is compared with the stored one.
#include "io/hdf5_file.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "io/child_process.h"
#include "io/hdf5_image.h"
#include "io/hdf5_library.h"
#include "io/text_scanner.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

using namespace hdf5;

constexpr std::uint64_t kMaxInflation = 1032;  // the most that deflate can do
constexpr int kMaxRank = 8;
constexpr ChildLimits kLimits = {.processor_time = std::chrono::seconds(600)},
                      kLimitsOfOneMap = {.processor_time = std::chrono::seconds(60), .memory = 1U << 30U};

[[noreturn]] void refuse(std::string_view what) { throw std::runtime_error(std::string(what)); }

bool is_numeric(hid_t type) { return H5Tget_class(type) == H5T_INTEGER || H5Tget_class(type) == H5T_FLOAT; }

bool is_unsigned(hid_t type) {
  return H5Tget_class(type) == H5T_INTEGER && H5Tget_sign(type) == H5T_SGN_NONE;
}

// Aborts if a value does not fit; by default the library stores the largest that does.
H5T_conv_ret_t refuse_overflow(H5T_conv_except_t what, hid_t, hid_t, void*, void*, void*) {
  return what == H5T_CONV_EXCEPT_RANGE_HI || what == H5T_CONV_EXCEPT_RANGE_LOW ? H5T_CONV_ABORT
                                                                               : H5T_CONV_UNHANDLED;
}

template <class T>
ArrayValues read_values(hid_t set, std::size_t count) {
  std::vector<T> values(count);
  const Handle transfer = property_list(H5P_DATASET_XFER);
  must(H5Pset_type_conv_cb(transfer, refuse_overflow, nullptr), "H5Pset_type_conv_cb");
  if (count > 0 && H5Dread(set, type_of<T>(), H5S_ALL, H5S_ALL, transfer, values.data()) < 0)
    refuse(
        "its values cannot be read: damaged, packed by an unknown filter, or beyond the range of their type");
  return values;
}

bool is_within(hid_t real_type, std::size_t exponent_bits, std::size_t mantissa_bits) {
  std::size_t sign = 0, exponent = 0, exponent_size = 0, mantissa = 0, mantissa_size = 0;
  must(H5Tget_fields(real_type, &sign, &exponent, &exponent_size, &mantissa, &mantissa_size),
       "H5Tget_fields");
  return exponent_size <= exponent_bits && mantissa_size <= mantissa_bits;
}

using Reader = ArrayValues (*)(hid_t set, std::size_t count);

// Reads numbers of a stored type as the narrowest type of ours that is equal to each, but for unsigned ones
// of 8 bytes, of which the largest are refused; null if there is none.
Reader reader_of(hid_t type) {
  if (H5Tget_class(type) == H5T_FLOAT)
    return is_within(type, 8, 23)    ? read_values<float>
           : is_within(type, 11, 52) ? read_values<double>
                                     : nullptr;
  const std::size_t size = H5Tget_size(type);
  if (size == 1 && is_unsigned(type)) return read_values<std::uint8_t>;
  if (size < 4 || (size == 4 && !is_unsigned(type))) return read_values<std::int32_t>;
  return size <= 8 ? read_values<std::int64_t> : nullptr;
}

std::string read_text(hid_t attribute, hid_t type, hid_t space) {
  if (H5Tis_variable_str(type) > 0) {
    char* begin = nullptr;
    must(H5Aread(attribute, type, &begin), "H5Aread");
    std::string text(begin == nullptr ? "" : begin);
    must(H5Dvlen_reclaim(type, space, H5P_DEFAULT, &begin), "H5Dvlen_reclaim");
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
  if (!is_numeric(type) || reader_of(type) == nullptr || (is_unsigned(type) && H5Tget_size(type) == 8))
    refuse(in_quotes(name) + " is neither a text nor a number that can be read");
  double real = 0;
  std::int64_t integer = 0;
  must(H5Aread(attribute, kind == H5T_FLOAT ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT64,
               kind == H5T_FLOAT ? static_cast<void*>(&real) : &integer),
       "H5Aread");
  return kind == H5T_FLOAT ? AttributeValue(real) : AttributeValue(integer);
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
  if (rank > kMaxRank) refuse(fmt::format("it has {} dimensions, expected at most {}", rank, kMaxRank));
  hsize_t extents[kMaxRank] = {};
  must(H5Sget_simple_extent_dims(space, extents, nullptr), "H5Sget_simple_extent_dims");
  return {extents, extents + rank};
}

Handle type_of_set(hid_t set) { return {H5Dget_type(set), H5Tclose, "H5Dget_type"}; }

// Size of an array whose values take `bytes` each. Throws if it overflows.
std::uint64_t bytes_of(std::uint64_t bytes, const std::vector<std::size_t>& shape) {
  for (const std::uint64_t extent : shape)
    if (__builtin_mul_overflow(bytes, extent, &bytes)) refuse("it claims more values than can be");
  return bytes;
}

// Throws unless the file holds about as much as the data set claims: nothing else limits what is allocated.
void check_storage(hid_t set, std::uint64_t value, const std::vector<std::size_t>& shape,
                   std::uint64_t file) {
  const Handle layout(H5Dget_create_plist(set), H5Pclose, "H5Dget_create_plist");
  if (H5Pget_layout(layout) == H5D_VIRTUAL || H5Pget_external_count(layout) != 0)
    refuse("its values are in other files");
  const std::uint64_t claimed = bytes_of(value, shape);
  if (claimed == 0) return;
  const std::uint64_t stored = std::min<std::uint64_t>(H5Dget_storage_size(set), file);
  bool plausible = stored == claimed;
  if (H5Pget_layout(layout) == H5D_CHUNKED) {
    hsize_t chunk[kMaxRank] = {};
    must(H5Pget_chunk(layout, kMaxRank, chunk), "H5Pget_chunk");
    const std::uint64_t chunk_bytes = bytes_of(value, {chunk, chunk + shape.size()});
    plausible = std::max(claimed, chunk_bytes) / kMaxInflation <= stored && stored > 0;
  }
  if (!plausible) refuse(fmt::format("it claims {} bytes of values, and {} are stored", claimed, stored));
}

// `file`: size of the whole file, bytes. `most`: bytes of values that are read.
Array read_array(hid_t set, const std::string& name, std::uint64_t file,
                 std::uint64_t most = std::numeric_limits<std::uint64_t>::max()) {
  const Handle type = type_of_set(set);
  if (!is_numeric(type)) refuse("it does not hold numbers");
  const Reader read = reader_of(type);
  if (read == nullptr)
    refuse(fmt::format("its numbers of {} bytes are wider than float64 and int64: write them as one of these",
                       H5Tget_size(type)));
  Array array{.name = name, .shape = shape_of(set), .values = {}, .unit = {}, .description = {}};
  const std::size_t size = H5Tget_size(type);
  check_storage(set, size, array.shape, file);
  if (const std::uint64_t bytes = bytes_of(size, array.shape); bytes > most)
    refuse(too_many_bytes(bytes, most));
  array.values = read(set, array.count());
  return array;
}

Handle opened_set(hid_t file, const std::string& name) {
  return {H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose, "H5Dopen"};
}

Handle unlocked_access() {
  Handle access = property_list(H5P_FILE_ACCESS);
  must(H5Pset_file_locking(access, false, true), "H5Pset_file_locking");
  return access;
}

[[noreturn]] void fail(std::string_view file, const std::runtime_error& error) {
  throw InputError(fmt::format("{}: not a readable HDF5 file ({})", file, error.what()));
}

}  // namespace

Bytes hdf5::image_by_library(const Hdf5Content& content) {
  std::vector<std::optional<PackedChunks>> chunks;
  for (const Array& array : content.arrays) chunks.push_back(packed(array));
  const auto lock = library();
  const Handle file = created_file(image_name().c_str(), core_access());
  const Handle links = groups_between();
  for (const auto& [name, value] : content.attributes) write_attribute(file, name, value);
  for (std::size_t i = 0; i < content.arrays.size(); ++i)
    write_array(file, links, content.arrays[i], chunks[i]);
  must(H5Fflush(file, H5F_SCOPE_LOCAL), "H5Fflush");
  const ssize_t size = H5Fget_file_image(file, nullptr, 0);
  if (size <= 0) throw std::runtime_error("HDF5: H5Fget_file_image failed");
  Bytes image(static_cast<std::size_t>(size));
  if (H5Fget_file_image(file, image.data(), image.size()) != size)
    throw std::runtime_error("HDF5: H5Fget_file_image failed");
  return image;
}

Hdf5Content hdf5::content_by_library(std::span<const std::byte> image) {
  const auto lock = library();
  const Handle file = opened_image(image);
  Hdf5Content content{{}, read_attributes(file)};
  for (const std::string& path : data_sets_in(file, image.size())) {
    const Handle set = opened_set(file, path);
    Array array = read_array(set, path, image.size());
    array.unit = text_beside(set, "unit");
    array.description = text_beside(set, "description");
    content.arrays.push_back(std::move(array));
  }
  return content;
}

Bytes hdf5_image(const Hdf5Content& content) {
  auto image = written_image(content);
  return image ? std::move(*image) : image_by_library(content);
}

Hdf5Content hdf5_content(std::span<const std::byte> image, std::string_view name) try {
  auto content = parsed_image(image);
  return content ? std::move(*content) : content_by_library(image);
} catch (const std::runtime_error& error) {
  fail(name, error);
}

// The child sends the content as an image of ours, or a message, after a byte that tells which.
Hdf5Content foreign_hdf5_content(std::span<const std::byte> image, std::string_view name) {
  if (auto content = parsed_image(image)) return std::move(*content);
  constexpr std::byte kImage{'i'}, kMessage{'m'};
  const auto send_as = [](const Send& send, std::byte kind, std::span<const std::byte> bytes) {
    send({&kind, 1});
    send(bytes);
  };
  const auto [sent, failure] = run_in_child(
      kLimits,
      [&](const Send& send) {
        try {
          send_as(send, kImage, hdf5_image(content_by_library(image)));
        } catch (const std::runtime_error& error) {
          send_as(send, kMessage, std::as_bytes(std::span(std::string_view(error.what()))));
        }
      },
      fork_beside_hdf5);
  if (!failure.empty() || sent.empty())
    throw InputError(
        fmt::format("{}: damaged: the HDF5 library that reads it {}; write the file again", name, failure));
  const auto bytes = std::as_bytes(std::span(sent));
  if (bytes[0] == kMessage) fail(name, std::runtime_error(sent.substr(1)));
  return hdf5_content(bytes.subspan(1), name);
}

// --- a foreign file, one data set at a time ---------------------------------------------------------------

struct Hdf5File::Open {
  explicit Open(const std::filesystem::path& path)
      : name(path.string()),
        file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, unlocked_access()), H5Fclose, "H5Fopen") {
    must(H5Fget_filesize(file, &bytes), "H5Fget_filesize");
  }
  std::vector<std::string> arrays() const {
    std::vector<std::string> names = data_sets_in(file, bytes);
    std::erase_if(names,
                  [&](const std::string& set) { return !is_numeric(type_of_set(opened_set(file, set))); });
    std::sort(names.begin(), names.end());
    return names;
  }

  static void read_all(const std::filesystem::path& path);
  static void survive_reading(const std::filesystem::path& path);

  std::string name;
  Handle file;
  hsize_t bytes = 0;
};

void Hdf5File::Open::read_all(const std::filesystem::path& path) try {
  const auto lock = library();
  const Open open(path);
  for (const std::string& name : open.arrays()) try {
      read_array(opened_set(open.file, name), name, open.bytes, kMaxItemBytes);
    } catch (const std::exception&) {  // reported when the parent reads it
    }
} catch (const std::exception&) {  // likewise
}

// Damaged bytes make the library crash before it can refuse them (1.10.8: within some thousand random
// changes), so a child process reads everything first.
void Hdf5File::Open::survive_reading(const std::filesystem::path& path) {
  const ChildResult result = run_in_child(
      kLimits, [&](const Send&) { read_all(path); }, fork_beside_hdf5);
  if (!result.failure.empty())
    throw InputError(fmt::format("{}: damaged: the HDF5 library that reads it {}; write the file again",
                                 path.string(), result.failure));
}

Hdf5File::Hdf5File(const std::filesystem::path& path, bool in_child_first) {
  require_regular_file(path);
  if (in_child_first) Open::survive_reading(path);
  const auto lock = library();
  try {
    open_ = std::make_unique<Open>(path);
  } catch (const std::runtime_error& error) {
    fail(path.string(), error);
  }
}

Hdf5File::~Hdf5File() {
  const auto lock = library();
  open_.reset();
}

std::vector<std::string> Hdf5File::arrays() const try {
  const auto lock = library();
  return open_->arrays();
} catch (const std::runtime_error& error) {
  fail(open_->name, error);
}

Array Hdf5File::read(const std::string& name) const try {
  const auto lock = library();
  return read_array(opened_set(open_->file, name), name, open_->bytes, kMaxItemBytes);
} catch (const std::exception& error) {
  throw InputError(fmt::format("{}: data set {}: {}", open_->name, in_quotes(name), error.what()));
}

ScalarField read_hdf5_values(const std::filesystem::path& path, std::string_view name) {
  const auto read = [&] {
    const Hdf5File file(path, false);
    const std::vector<std::string> sets = file.arrays();
    const auto named = std::find(sets.begin(), sets.end(), "saliency");
    if (named == sets.end() && sets.size() != 1)
      throw InputError(
          fmt::format("it has {} data sets of numbers, expected one, or one called 'saliency'", sets.size()));
    const std::string& chosen = named == sets.end() ? sets[0] : *named;
    const Array array = file.read(chosen);
    try {
      return point_values(array);
    } catch (const InputError& error) {
      throw InputError(fmt::format("data set {}: {}", in_quotes(chosen), error.what()));
    }
  };
  return numbers_from_child(kLimitsOfOneMap, name, read, fork_beside_hdf5);
}

}  // namespace salbench
