// The one file that knows the HDF5 library (C API, 1.10). The core driver keeps the file in memory; its image
// is taken with H5Fget_file_image. H5Fcreate with the latest format writes compact object headers: a table of
// six scores takes 2 KB in place of 6.
#include "io/hdf5_file.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include <fmt/format.h>
#include <hdf5.h>

#include "stages/core/errors.h"

namespace salbench {
namespace {

constexpr std::size_t kCompressFrom = 64 * 1024;  // bytes; below, filters cost more than they save
constexpr std::size_t kChunkRows = 4096;

// An HDF5 identifier with the function that closes it; a negative one is the library's failure.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t), const char* what) : id_(id), close_(close) {
    if (id_ < 0) throw std::runtime_error(fmt::format("HDF5: {} failed", what));
  }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&&) = delete;
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const { return id_; }  // NOLINT: that is what the C API takes

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

void must(herr_t status, const char* what) {
  if (status < 0) throw std::runtime_error(fmt::format("HDF5: {} failed", what));
}

template <class T>
struct Type;
template <>
struct Type<double> {
  static hid_t stored() { return H5T_IEEE_F64LE; }
  static hid_t memory() { return H5T_NATIVE_DOUBLE; }
};
template <>
struct Type<float> {
  static hid_t stored() { return H5T_IEEE_F32LE; }
  static hid_t memory() { return H5T_NATIVE_FLOAT; }
};
template <>
struct Type<std::int32_t> {
  static hid_t stored() { return H5T_STD_I32LE; }
  static hid_t memory() { return H5T_NATIVE_INT32; }
};
template <>
struct Type<std::int64_t> {
  static hid_t stored() { return H5T_STD_I64LE; }
  static hid_t memory() { return H5T_NATIVE_INT64; }
};

Handle property_list(hid_t kind) { return {H5Pcreate(kind), H5Pclose, "H5Pcreate"}; }
Handle scalar_space() { return {H5Screate(H5S_SCALAR), H5Sclose, "H5Screate"}; }

// Files in memory are told apart by their names alone: two of one name would be one file to the library.
std::string image_name() {
  static std::atomic<std::uint64_t> counter = 0;
  return fmt::format("image {}", counter++);
}

Handle core_access() {
  Handle access = property_list(H5P_FILE_ACCESS);
  must(H5Pset_fapl_core(access, 1U << 16U, 0), "H5Pset_fapl_core");
  return access;
}

Handle string_type(std::size_t length) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "H5Tcopy");
  must(H5Tset_size(type, std::max<std::size_t>(length, 1)), "H5Tset_size");
  must(H5Tset_cset(type, H5T_CSET_UTF8), "H5Tset_cset");
  must(H5Tset_strpad(type, H5T_STR_NULLPAD), "H5Tset_strpad");
  return type;
}

void write_attribute(hid_t object, const std::string& name, hid_t stored, hid_t memory, const void* value) {
  const Handle space = scalar_space();
  const Handle attribute(H5Acreate2(object, name.c_str(), stored, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                         "H5Acreate");
  must(H5Awrite(attribute, memory, value), "H5Awrite");
}

void write_attribute(hid_t object, const std::string& name, const AttributeValue& value) {
  if (const auto* text = std::get_if<std::string>(&value)) {
    const Handle type = string_type(text->size());
    write_attribute(object, name, type, type, text->c_str());
  } else if (const auto* real = std::get_if<double>(&value)) {
    write_attribute(object, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, real);
  } else {
    write_attribute(object, name, H5T_STD_I64LE, H5T_NATIVE_INT64, &std::get<std::int64_t>(value));
  }
}

// Of coordinates deflate saves an eighth, of descriptors (single precision, mostly zeros) a half.
Handle creation_properties(const Array& array) {
  Handle properties = property_list(H5P_DATASET_CREATE);
  must(H5Pset_obj_track_times(properties, false), "H5Pset_obj_track_times");
  if (!std::holds_alternative<std::vector<float>>(array.values) ||
      array.count() * sizeof(float) < kCompressFrom)
    return properties;
  std::vector<hsize_t> chunk(array.shape.begin(), array.shape.end());
  chunk[0] = std::min<hsize_t>(chunk[0], kChunkRows);
  must(H5Pset_chunk(properties, static_cast<int>(chunk.size()), chunk.data()), "H5Pset_chunk");
  must(H5Pset_shuffle(properties), "H5Pset_shuffle");
  must(H5Pset_deflate(properties, 1), "H5Pset_deflate");
  return properties;
}

void write_array(hid_t file, hid_t links, const Array& array) {
  const std::vector<hsize_t> shape(array.shape.begin(), array.shape.end());
  const Handle space = shape.empty()
                           ? scalar_space()
                           : Handle(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
                                    H5Sclose, "H5Screate_simple");
  const Handle properties = creation_properties(array);
  std::visit(
      [&]<class T>(const std::vector<T>& values) {
        if (values.size() != array.count())
          throw std::logic_error(fmt::format("array {} has {} values for its shape of {}", array.name,
                                             values.size(), array.count()));
        const Handle set(
            H5Dcreate2(file, array.name.c_str(), Type<T>::stored(), space, links, properties, H5P_DEFAULT),
            H5Dclose, "H5Dcreate");
        if (!values.empty())
          must(H5Dwrite(set, Type<T>::memory(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), "H5Dwrite");
        write_attribute(set, "unit", array.unit);
        write_attribute(set, "description", array.description);
      },
      array.values);
}

AttributeValue read_attribute(hid_t attribute) {
  const Handle type(H5Aget_type(attribute), H5Tclose, "H5Aget_type");
  switch (H5Tget_class(type)) {
    case H5T_STRING: {
      std::string text(H5Tget_size(type), '\0');
      must(H5Aread(attribute, type, text.data()), "H5Aread");
      text.resize(std::min(text.size(), text.find('\0')));  // an empty text is stored as one zero byte
      return text;
    }
    case H5T_FLOAT: {
      double value = 0;
      must(H5Aread(attribute, H5T_NATIVE_DOUBLE, &value), "H5Aread");
      return value;
    }
    default: {
      std::int64_t value = 0;
      must(H5Aread(attribute, H5T_NATIVE_INT64, &value), "H5Aread");
      return value;
    }
  }
}

herr_t append_attribute(hid_t object, const char* name, const H5A_info_t*, void* attributes) {
  try {
    const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose, "H5Aopen");
    static_cast<Attributes*>(attributes)->emplace_back(name, read_attribute(attribute));
    return 0;
  } catch (const std::exception&) {
    return -1;  // no exception may cross the C library; the iteration reports the failure
  }
}

Attributes read_attributes(hid_t object) {
  Attributes attributes;
  must(H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, nullptr, append_attribute, &attributes), "H5Aiterate");
  return attributes;
}

template <class T>
ArrayValues read_values(hid_t set, std::size_t count) {
  std::vector<T> values(count);
  if (count > 0)
    must(H5Dread(set, Type<T>::memory(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), "H5Dread");
  return values;
}

ArrayValues read_values(hid_t set, hid_t type, std::size_t count) {
  const bool real = H5Tget_class(type) == H5T_FLOAT;
  const bool wide = H5Tget_size(type) == 8;
  if (real) return wide ? read_values<double>(set, count) : read_values<float>(set, count);
  return wide ? read_values<std::int64_t>(set, count) : read_values<std::int32_t>(set, count);
}

Array read_array(hid_t file, const char* name) {
  const Handle set(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose, "H5Dopen");
  const Handle space(H5Dget_space(set), H5Sclose, "H5Dget_space");
  const Handle type(H5Dget_type(set), H5Tclose, "H5Dget_type");
  std::vector<hsize_t> extents(static_cast<std::size_t>(std::max(H5Sget_simple_extent_ndims(space), 0)));
  must(H5Sget_simple_extent_dims(space, extents.data(), nullptr), "H5Sget_simple_extent_dims");
  Array array{
      .name = name, .shape = {extents.begin(), extents.end()}, .values = {}, .unit = {}, .description = {}};
  array.values = read_values(set, type, array.count());
  for (auto& [key, value] : read_attributes(set)) {
    if (key == "unit") array.unit = std::get<std::string>(value);
    if (key == "description") array.description = std::get<std::string>(value);
  }
  return array;
}

herr_t append_name(hid_t, const char* name, const H5O_info_t* info, void* names) {
  if (info->type == H5O_TYPE_DATASET) static_cast<std::vector<std::string>*>(names)->emplace_back(name);
  return 0;
}

}  // namespace

Bytes hdf5_image(const Hdf5Content& content) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // per thread: failures are told by exceptions, not on stderr
  const Handle access = core_access();
  const Handle creation = property_list(H5P_FILE_CREATE);
  must(H5Pset_obj_track_times(creation, false), "H5Pset_obj_track_times");
  const Handle file(H5Fcreate(image_name().c_str(), H5F_ACC_TRUNC, creation, access), H5Fclose, "H5Fcreate");
  const Handle links = property_list(H5P_LINK_CREATE);
  must(H5Pset_create_intermediate_group(links, 1), "H5Pset_create_intermediate_group");
  for (const auto& [name, value] : content.attributes) write_attribute(file, name, value);
  for (const Array& array : content.arrays) write_array(file, links, array);
  must(H5Fflush(file, H5F_SCOPE_LOCAL), "H5Fflush");
  const ssize_t size = H5Fget_file_image(file, nullptr, 0);
  if (size <= 0) throw std::runtime_error("HDF5: H5Fget_file_image failed");
  Bytes image(static_cast<std::size_t>(size));
  if (H5Fget_file_image(file, image.data(), image.size()) != size)
    throw std::runtime_error("HDF5: H5Fget_file_image failed");
  return image;
}

Hdf5Content hdf5_content(std::span<const std::byte> image, std::string_view name) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  try {
    const Handle access = core_access();
    // The library copies the image; it never writes to it in read-only mode.
    must(H5Pset_file_image(access, const_cast<std::byte*>(image.data()), image.size()), "H5Pset_file_image");
    const Handle file(H5Fopen(image_name().c_str(), H5F_ACC_RDONLY, access), H5Fclose, "H5Fopen");
    std::vector<std::string> names;
    must(H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_INC, append_name, &names, H5O_INFO_BASIC), "H5Ovisit");
    Hdf5Content content{{}, read_attributes(file)};
    for (const std::string& set : names) content.arrays.push_back(read_array(file, set.c_str()));
    return content;
  } catch (const std::exception& error) {
    throw InputError(fmt::format("{}: not a readable HDF5 file ({})", name, error.what()));
  }
}

}  // namespace salbench
