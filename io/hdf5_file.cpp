// The one file that knows the HDF5 library (C API, 1.10). The core driver keeps the file in memory; its image
// is taken with H5Fget_file_image, in the library's earliest format: the only one of which it takes a correct
// image.
#include "io/hdf5_file.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include <fmt/format.h>
#include <hdf5.h>

#include "io/records.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

constexpr std::size_t kCompressFrom = 64 * 1024;  // bytes; below, filters cost more than they save
constexpr std::size_t kChunkRows = 4096;
constexpr std::size_t kLongText = 60'000;  // bytes; an object header has no room for attributes beyond 64 KB

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
  if (length != H5T_VARIABLE) must(H5Tset_strpad(type, H5T_STR_NULLPAD), "H5Tset_strpad");
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
    const bool on_heap = text->size() > kLongText;
    const char* begin = text->c_str();
    const Handle type = string_type(on_heap ? H5T_VARIABLE : text->size());
    write_attribute(object, name, type, type, on_heap ? static_cast<const void*>(&begin) : begin);
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

// Opens or makes the group or data set of that name.
Handle opened_object(hid_t file, hid_t links, const std::string& name) {
  if (H5Lexists(file, name.c_str(), H5P_DEFAULT) > 0)
    return {H5Oopen(file, name.c_str(), H5P_DEFAULT), H5Oclose, "H5Oopen"};
  const Handle properties = property_list(H5P_GROUP_CREATE);
  must(H5Pset_obj_track_times(properties, false), "H5Pset_obj_track_times");
  return {H5Gcreate2(file, name.c_str(), links, properties, H5P_DEFAULT), H5Gclose, "H5Gcreate"};
}

Handle record_type(const std::vector<Field>& fields, bool stored) {
  Handle record(H5Tcreate(H5T_COMPOUND, record_size(fields)), H5Tclose, "H5Tcreate");
  for (const Field& field : fields) {
    const Handle text = string_type(field.size);
    const hid_t integer = stored ? Type<std::int64_t>::stored() : Type<std::int64_t>::memory();
    const hid_t real = stored ? Type<double>::stored() : Type<double>::memory();
    const hid_t type = field.type == FieldType::text ? text : field.type == FieldType::real ? real : integer;
    must(H5Tinsert(record, field.name.c_str(), field.offset, type), "H5Tinsert");
  }
  return record;
}

void write_table(hid_t file, hid_t links, const Hdf5Table& table) {
  const Records records = records_from(table.table);
  const hsize_t rows = table.table.rows.size();
  const Handle space(H5Screate_simple(1, &rows, nullptr), H5Sclose, "H5Screate_simple");
  const Handle properties = property_list(H5P_DATASET_CREATE);
  must(H5Pset_obj_track_times(properties, false), "H5Pset_obj_track_times");
  const Handle stored = record_type(records.fields, true), memory = record_type(records.fields, false);
  const Handle set(H5Dcreate2(file, table.name.c_str(), stored, space, links, properties, H5P_DEFAULT),
                   H5Dclose, "H5Dcreate");
  if (rows > 0) must(H5Dwrite(set, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, records.bytes.data()), "H5Dwrite");
  write_attribute(set, "description", table.description);
}

void write_link(hid_t file, hid_t links, const Hdf5Link& link) {
  must(
      H5Lcreate_external(link.file.c_str(), link.object.c_str(), file, link.name.c_str(), links, H5P_DEFAULT),
      "H5Lcreate_external");
}

// --- reading
// ------------------------------------------------------------------------------------------------

std::string read_text(hid_t attribute, hid_t type) {
  if (H5Tis_variable_str(type) > 0) {
    char* begin = nullptr;
    must(H5Aread(attribute, type, &begin), "H5Aread");
    std::string text(begin == nullptr ? "" : begin);
    const Handle space(H5Aget_space(attribute), H5Sclose, "H5Aget_space");
    must(H5Dvlen_reclaim(type, space, H5P_DEFAULT, &begin), "H5Dvlen_reclaim");
    return text;
  }
  std::string text(H5Tget_size(type), '\0');
  must(H5Aread(attribute, type, text.data()), "H5Aread");
  text.resize(std::min(text.size(), text.find('\0')));  // an empty text is stored as one zero byte
  return text;
}

AttributeValue read_attribute(hid_t attribute) {
  const Handle type(H5Aget_type(attribute), H5Tclose, "H5Aget_type");
  switch (H5Tget_class(type)) {
    case H5T_STRING:
      return read_text(attribute, type);
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

std::string text_taken(Attributes& attributes, std::string_view name) {
  const auto found =
      std::find_if(attributes.begin(), attributes.end(), [&](const auto& a) { return a.first == name; });
  if (found == attributes.end()) return {};
  std::string text = std::get<std::string>(found->second);
  attributes.erase(found);
  return text;
}

Array read_array(hid_t set, hid_t type, const std::string& name, Attributes& attributes) {
  const Handle space(H5Dget_space(set), H5Sclose, "H5Dget_space");
  std::vector<hsize_t> extents(static_cast<std::size_t>(std::max(H5Sget_simple_extent_ndims(space), 0)));
  must(H5Sget_simple_extent_dims(space, extents.data(), nullptr), "H5Sget_simple_extent_dims");
  Array array{.name = name,
              .shape = {extents.begin(), extents.end()},
              .values = {},
              .unit = text_taken(attributes, "unit"),
              .description = text_taken(attributes, "description")};
  array.values = read_values(set, type, array.count());
  return array;
}

std::vector<Field> fields_of(hid_t record) {
  std::vector<Field> fields;
  const int members = H5Tget_nmembers(record);
  for (unsigned m = 0; m < static_cast<unsigned>(std::max(members, 0)); ++m) {
    char* name = H5Tget_member_name(record, m);
    Field field{name == nullptr ? "" : name};
    H5free_memory(name);
    const Handle type(H5Tget_member_type(record, m), H5Tclose, "H5Tget_member_type");
    const H5T_class_t kind = H5Tget_class(type);
    if (kind != H5T_STRING) field.type = kind == H5T_FLOAT ? FieldType::real : FieldType::integer;
    field.size = kind == H5T_STRING ? H5Tget_size(type) : sizeof(double);
    fields.push_back(std::move(field));
  }
  return packed(std::move(fields));
}

Hdf5Table read_table(hid_t set, hid_t type, const std::string& name, Attributes& attributes) {
  const Handle space(H5Dget_space(set), H5Sclose, "H5Dget_space");
  const auto rows = static_cast<std::size_t>(std::max<hssize_t>(H5Sget_simple_extent_npoints(space), 0));
  Records records{fields_of(type), {}};
  records.bytes.resize(rows * record_size(records.fields));
  const Handle memory = record_type(records.fields, false);
  if (rows > 0) must(H5Dread(set, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, records.bytes.data()), "H5Dread");
  return {name, table_from(records), text_taken(attributes, "description")};
}

void read_object(hid_t file, const std::string& name, Hdf5Content& content) {
  const Handle object(H5Oopen(file, name.c_str(), H5P_DEFAULT), H5Oclose, "H5Oopen");
  Attributes attributes = read_attributes(object);
  if (H5Iget_type(object) == H5I_DATASET) {
    const Handle type(H5Dget_type(object), H5Tclose, "H5Dget_type");
    if (H5Tget_class(type) == H5T_COMPOUND)
      content.tables.push_back(read_table(object, type, name, attributes));
    else
      content.arrays.push_back(read_array(object, type, name, attributes));
  }
  if (!attributes.empty()) content.attributes_of.push_back({name, std::move(attributes)});
}

herr_t append_name(hid_t, const char* name, const H5O_info_t*, void* names) {
  if (std::string_view(name) != ".") static_cast<std::vector<std::string>*>(names)->emplace_back(name);
  return 0;
}

herr_t append_link(hid_t group, const char* name, const H5L_info_t* info, void* links) {
  if (info->type != H5L_TYPE_EXTERNAL) return 0;
  std::string packed_link(info->u.val_size, '\0');
  const char* file = nullptr;
  const char* object = nullptr;
  if (H5Lget_val(group, name, packed_link.data(), packed_link.size(), H5P_DEFAULT) < 0 ||
      H5Lunpack_elink_val(packed_link.data(), packed_link.size(), nullptr, &file, &object) < 0)
    return -1;
  static_cast<std::vector<Hdf5Link>*>(links)->push_back({name, file, object});
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
  for (const Hdf5Table& table : content.tables) write_table(file, links, table);
  for (const Hdf5Link& link : content.links) write_link(file, links, link);
  for (const auto& [name, attributes] : content.attributes_of) {
    const Handle object = opened_object(file, links, name);
    for (const auto& [key, value] : attributes) write_attribute(object, key, value);
  }
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
    for (const std::string& object : names) read_object(file, object, content);
    must(H5Lvisit(file, H5_INDEX_NAME, H5_ITER_INC, append_link, &content.links), "H5Lvisit");
    return content;
  } catch (const std::exception& error) {
    throw InputError(fmt::format("{}: not a readable HDF5 file ({})", name, error.what()));
  }
}

}  // namespace salbench
