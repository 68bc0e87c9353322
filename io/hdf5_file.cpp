// The one file that knows the HDF5 library (C API, 1.10). The core driver keeps an artefact in memory; its
// image is taken with H5Fget_file_image, in the library's earliest format: the only one of which it takes a
// correct image.
//
// What a file says of itself is not believed: the library converts and fills whatever a data space declares.
// So class, size and space of a data set or attribute are checked before a value is read, and what is
// declared is held against what is stored.
#include "io/hdf5_file.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <mutex>
#include <optional>
#include <type_traits>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <hdf5.h>
#include <unistd.h>

#include "io/records.h"
#include "io/text_scanner.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

constexpr std::size_t kCompressFrom = 64 * 1024;  // bytes; below, filters cost more than they save
constexpr std::size_t kChunkRows = 4096;
constexpr std::size_t kLongText = 60'000;  // bytes; an object header has no room for attributes beyond 64 KB
constexpr std::uint64_t kMaxInflation = 1032;  // deflate cannot do more
constexpr int kMaxRank = 8;
constexpr std::ptrdiff_t kMaxDepth = 64;       // groups within groups; the library visits them by recursion
constexpr std::uint64_t kMinObjectBytes = 16;  // of an object and its link, in any version of the format

// Held while the library works, unless it is one that serialises its callers itself. Its clean-up at exit is
// left out: where a disk is full it goes round in circles, and every file has been closed by then.
std::unique_lock<std::mutex> library() {
  static std::mutex mutex;
  static const bool thread_safe = [] {
    hbool_t safe = false;
    return H5dont_atexit() >= 0 && H5is_library_threadsafe(&safe) >= 0 && safe;
  }();
  std::unique_lock lock(mutex, std::defer_lock);
  if (!thread_safe) lock.lock();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // per thread: failures are told by exceptions, not on stderr
  return lock;
}

// An HDF5 identifier with the function that closes it; a negative one is the library's failure.
class Handle {
 public:
  Handle(hid_t id, herr_t (*closer)(hid_t), const char* what) : id_(id), close_(closer) {
    if (id_ < 0) throw std::runtime_error(fmt::format("HDF5: {} failed", what));
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

void must(herr_t status, const char* what) {
  if (status < 0) throw std::runtime_error(fmt::format("HDF5: {} failed", what));
}

template <class T>
struct Type {
  static hid_t stored() {
    if constexpr (std::is_floating_point_v<T>)
      return sizeof(T) == 8 ? H5T_IEEE_F64LE : H5T_IEEE_F32LE;
    else
      return sizeof(T) == 8 ? H5T_STD_I64LE : H5T_STD_I32LE;
  }
  static hid_t memory() {
    if constexpr (std::is_floating_point_v<T>)
      return sizeof(T) == 8 ? H5T_NATIVE_DOUBLE : H5T_NATIVE_FLOAT;
    else
      return sizeof(T) == 8 ? H5T_NATIVE_INT64 : H5T_NATIVE_INT32;
  }
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

// --- reading ----------------------------------------------------------------------------------------------

[[noreturn]] void refuse(std::string_view what) { throw std::runtime_error(std::string(what)); }

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
  if ((kind != H5T_FLOAT && kind != H5T_INTEGER) || H5Tget_size(type) > sizeof(double))
    refuse(in_quotes(name) + " is neither a text nor a number");
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

bool is_numeric(hid_t set) {
  const Handle type(H5Dget_type(set), H5Tclose, "H5Dget_type");
  const H5T_class_t kind = H5Tget_class(type);
  return kind == H5T_INTEGER || kind == H5T_FLOAT;
}

// Bytes of so many values. Throws where that is no number that this machine has.
std::uint64_t bytes_of(std::uint64_t value, const std::vector<std::size_t>& shape) {
  std::uint64_t bytes = value;
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

// Aborts where a value does not fit: without, the library makes it the largest that does.
H5T_conv_ret_t refuse_overflow(H5T_conv_except_t what, hid_t, hid_t, void*, void*, void*) {
  return what == H5T_CONV_EXCEPT_RANGE_HI || what == H5T_CONV_EXCEPT_RANGE_LOW ? H5T_CONV_ABORT
                                                                               : H5T_CONV_UNHANDLED;
}

template <class T>
ArrayValues read_values(hid_t set, std::size_t count) {
  std::vector<T> values(count);
  const Handle transfer = property_list(H5P_DATASET_XFER);
  must(H5Pset_type_conv_cb(transfer, refuse_overflow, nullptr), "H5Pset_type_conv_cb");
  if (count > 0 && H5Dread(set, Type<T>::memory(), H5S_ALL, H5S_ALL, transfer, values.data()) < 0)
    refuse(
        "its values cannot be read: damaged, packed by an unknown filter, or beyond the range of their type");
  return values;
}

// `file`: bytes of the whole file.
Array read_array(hid_t set, const std::string& name, std::uint64_t file) {
  if (!is_numeric(set)) refuse("it does not hold numbers");
  const Handle type(H5Dget_type(set), H5Tclose, "H5Dget_type");
  const bool real = H5Tget_class(type) == H5T_FLOAT;
  const std::size_t size = H5Tget_size(type);
  if (size == 0 || size > (real ? sizeof(long double) : sizeof(std::int64_t)))
    refuse(fmt::format("its numbers are of {} bytes", size));
  Array array{.name = name, .shape = shape_of(set), .values = {}, .unit = {}, .description = {}};
  check_storage(set, size, array.shape, file);
  const std::size_t count = array.count();
  if (real)
    array.values = size == 8 ? read_values<double>(set, count) : read_values<float>(set, count);
  else
    array.values = size == 8 ? read_values<std::int64_t>(set, count) : read_values<std::int32_t>(set, count);
  return array;
}

struct Visit {
  std::vector<std::string> data_sets;
  std::uint64_t objects_left;  // more than this many are a damaged file's going round in circles
};

herr_t append_data_set(hid_t, const char* name, const H5O_info_t* info, void* data) {
  auto& visit = *static_cast<Visit*>(data);
  const std::string_view path(name);
  if (visit.objects_left-- == 0 || std::count(path.begin(), path.end(), '/') > kMaxDepth) return -1;
  if (info->type == H5O_TYPE_DATASET) visit.data_sets.emplace_back(path);
  return 0;
}

// By hard links alone: what other links lead to is not of this file.
std::vector<std::string> data_sets_in(hid_t file, std::uint64_t bytes) {
  Visit visit{{}, bytes / kMinObjectBytes};
  must(H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_INC, append_data_set, &visit, H5O_INFO_BASIC),
       "listing its objects");
  return std::move(visit.data_sets);
}

Handle opened_set(hid_t file, const std::string& name) {
  return {H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose, "H5Dopen"};
}

Handle opened_image(std::span<const std::byte> image) {
  const Handle access = core_access();
  // The library copies the image; it never writes to it in read-only mode.
  must(H5Pset_file_image(access, const_cast<std::byte*>(image.data()), image.size()), "H5Pset_file_image");
  return {H5Fopen(image_name().c_str(), H5F_ACC_RDONLY, access), H5Fclose, "H5Fopen"};
}

Handle unlocked_access() {
  Handle access = property_list(H5P_FILE_ACCESS);
  must(H5Pset_file_locking(access, false, true), "H5Pset_file_locking");
  return access;
}

Handle created_file(const char* name, hid_t access) {
  const Handle creation = property_list(H5P_FILE_CREATE);
  must(H5Pset_obj_track_times(creation, false), "H5Pset_obj_track_times");
  return {H5Fcreate(name, H5F_ACC_TRUNC, creation, access), H5Fclose, "H5Fcreate"};
}

Handle with_groups_between() {
  Handle links = property_list(H5P_LINK_CREATE);
  must(H5Pset_create_intermediate_group(links, 1), "H5Pset_create_intermediate_group");
  return links;
}

// --- a file on a disk that may be full
// ----------------------------------------------------------------------

// Where a write fails the library ends in a segmentation fault, then or when it closes the file. So this
// driver keeps the first error to itself, writes nothing from there on, and the writer asks for it after
// every step.
struct Disk {
  int fd = -1;
  int error = 0;  // errno of the first write that failed
};

struct DiskFile {
  H5FD_t base = {};  // the library's part, which stands first
  Disk* disk = nullptr;
  haddr_t allocated = 0, end = 0;
};

Disk& disk_of(H5FD_t* file) { return *reinterpret_cast<DiskFile*>(file)->disk; }

H5FD_t* open_on_disk(const char*, unsigned, hid_t access, haddr_t) {
  Disk* const* disk = static_cast<Disk* const*>(H5Pget_driver_info(access));
  return disk == nullptr ? nullptr : &(new DiskFile{.disk = *disk})->base;
}

herr_t read_from_disk(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t at, size_t size, void* into) {
  auto* bytes = static_cast<char*>(into);
  for (ssize_t got = 0; size > 0;
       bytes += got, at += static_cast<haddr_t>(got), size -= static_cast<size_t>(got)) {
    got = ::pread(disk_of(file).fd, bytes, size, static_cast<off_t>(at));
    if (got < 0 && errno != EINTR) return -1;
    if (got == 0) std::fill_n(bytes, size, '\0');  // allocated, and not written yet
    if (got <= 0) got = got == 0 ? static_cast<ssize_t>(size) : 0;
  }
  return 0;
}

herr_t write_to_disk(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t at, size_t size, const void* from) {
  auto& [base, disk, allocated, end] = *reinterpret_cast<DiskFile*>(file);
  end = std::max<haddr_t>(end, at + size);
  const auto* bytes = static_cast<const char*>(from);
  while (size > 0 && disk->error == 0) {
    const ssize_t put = ::pwrite(disk->fd, bytes, size, static_cast<off_t>(at));
    if (put < 0 && errno != EINTR) disk->error = errno;
    if (put <= 0) continue;
    bytes += put;
    at += static_cast<haddr_t>(put);
    size -= static_cast<size_t>(put);
  }
  return 0;
}

herr_t truncate_on_disk(H5FD_t* file, hid_t, hbool_t) {
  auto& [base, disk, allocated, end] = *reinterpret_cast<DiskFile*>(file);
  if (disk->error == 0 && end != allocated && ::ftruncate(disk->fd, static_cast<off_t>(allocated)) != 0)
    disk->error = errno;
  end = allocated;
  return 0;
}

Handle disk_access(Disk* disk) {
  static const hid_t driver = [] {
    H5FD_class_t functions = {};
    functions.name = "salbench";
    functions.maxaddr = (haddr_t{1} << 63U) - 1;
    functions.fc_degree = H5F_CLOSE_WEAK;
    functions.fapl_size = sizeof(Disk*);
    functions.open = open_on_disk;
    functions.close = [](H5FD_t* file) -> herr_t {
      delete reinterpret_cast<DiskFile*>(file);
      return 0;
    };
    functions.query = [](const H5FD_t*, unsigned long* flags) -> herr_t {
      *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
               H5FD_FEAT_AGGREGATE_SMALLDATA;
      return 0;
    };
    functions.get_eoa = [](const H5FD_t* file, H5FD_mem_t) {
      return reinterpret_cast<const DiskFile*>(file)->allocated;
    };
    functions.set_eoa = [](H5FD_t* file, H5FD_mem_t, haddr_t allocated) -> herr_t {
      reinterpret_cast<DiskFile*>(file)->allocated = allocated;
      return 0;
    };
    functions.get_eof = [](const H5FD_t* file, H5FD_mem_t) {
      return reinterpret_cast<const DiskFile*>(file)->end;
    };
    functions.read = read_from_disk;
    functions.write = write_to_disk;
    functions.truncate = truncate_on_disk;
    const H5FD_mem_t map[] = H5FD_FLMAP_DICHOTOMY;
    std::copy(std::begin(map), std::end(map), functions.fl_map);
    return H5FDregister(&functions);
  }();
  Handle access = property_list(H5P_FILE_ACCESS);
  must(H5Pset_driver(access, driver, static_cast<const void*>(&disk)), "H5Pset_driver");
  return access;
}

}  // namespace

Bytes hdf5_image(const Hdf5Content& content) {
  const auto lock = library();
  const Handle file = created_file(image_name().c_str(), core_access());
  const Handle links = with_groups_between();
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

Hdf5Content hdf5_content(std::span<const std::byte> image, std::string_view name) try {
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
} catch (const std::exception& error) {
  throw InputError(fmt::format("{}: not a readable HDF5 file ({})", name, error.what()));
}

// --- a foreign file, one data set at a time ---------------------------------------------------------------

struct Hdf5File::Open {
  std::string name;
  Handle file;
  hsize_t bytes = 0;
};

Hdf5File::Hdf5File(const std::filesystem::path& path) {
  require_regular_file(path);
  const auto lock = library();
  try {
    const Handle access = unlocked_access();
    Open open{path.string(), {H5Fopen(path.c_str(), H5F_ACC_RDONLY, access), H5Fclose, "H5Fopen"}};
    must(H5Fget_filesize(open.file, &open.bytes), "H5Fget_filesize");
    open_ = std::make_unique<Open>(std::move(open));
  } catch (const std::runtime_error& error) {
    throw InputError(fmt::format("{}: not a readable HDF5 file ({})", path.string(), error.what()));
  }
}

Hdf5File::~Hdf5File() {
  const auto lock = library();
  open_.reset();
}

std::vector<std::string> Hdf5File::arrays() const try {
  const auto lock = library();
  std::vector<std::string> names = data_sets_in(open_->file, open_->bytes);
  std::erase_if(names, [&](const std::string& name) { return !is_numeric(opened_set(open_->file, name)); });
  std::sort(names.begin(), names.end());
  return names;
} catch (const std::runtime_error& error) {
  throw InputError(fmt::format("{}: not a readable HDF5 file ({})", open_->name, error.what()));
}

Array Hdf5File::read(const std::string& name) const try {
  const auto lock = library();
  return read_array(opened_set(open_->file, name), name, open_->bytes);
} catch (const std::exception& error) {
  throw InputError(fmt::format("{}: data set {}: {}", open_->name, in_quotes(name), error.what()));
}

// --- a file written piece by piece ------------------------------------------------------------------------

struct Hdf5Writer::Open {
  explicit Open(const std::filesystem::path& path)
      : folder(path.parent_path().string()),
        disk{::open(path.c_str(), O_RDWR | O_TRUNC | O_CREAT | O_CLOEXEC, 0666)} {
    if (disk.fd < 0) disk.error = errno;
  }
  Open(const Open&) = delete;
  Open& operator=(const Open&) = delete;
  ~Open() {
    file.reset();
    if (disk.fd >= 0) ::close(disk.fd);
  }

  std::string folder;
  Disk disk;
  std::optional<Handle> file = {}, links = {};

  template <class Action>
  void write(const Action& action) {
    const auto lock = library();
    std::string failure;
    try {
      if (disk.error == 0) action();
    } catch (const std::runtime_error& error) {
      failure = error.what();
    }
    if (disk.error != 0) failure = system_reason(disk.error);
    if (!failure.empty()) throw StorageError(fmt::format("{}: cannot be written to: {}", folder, failure));
  }
};

Hdf5Writer::Hdf5Writer(const std::filesystem::path& path) : open_(std::make_unique<Open>(path)) {
  open_->write([&] {
    open_->file.emplace(created_file(path.c_str(), disk_access(&open_->disk)));
    open_->links.emplace(with_groups_between());
  });
}

Hdf5Writer::~Hdf5Writer() {
  const auto lock = library();
  open_.reset();
}

void Hdf5Writer::attributes(const std::string& object, const Attributes& attributes) {
  open_->write([&] {
    const Handle opened = opened_object(*open_->file, *open_->links, object);
    for (const auto& [name, value] : attributes) write_attribute(opened, name, value);
  });
}

void Hdf5Writer::array(const Array& array) {
  open_->write([&] { write_array(*open_->file, *open_->links, array); });
}

void Hdf5Writer::table(const Hdf5Table& table) {
  open_->write([&] { write_table(*open_->file, *open_->links, table); });
}

void Hdf5Writer::link(const Hdf5Link& link) {
  open_->write([&] {
    must(H5Lcreate_external(link.file.c_str(), link.object.c_str(), *open_->file, link.name.c_str(),
                            *open_->links, H5P_DEFAULT),
         "H5Lcreate_external");
  });
}

void Hdf5Writer::copy(const std::string& group, std::span<const std::byte> image) {
  open_->write([&] {
    const Handle artefact = opened_image(image);
    for (const std::string& name : data_sets_in(artefact, image.size()))
      must(H5Ocopy(artefact, name.c_str(), *open_->file, (group + "/" + name).c_str(), H5P_DEFAULT,
                   *open_->links),
           "H5Ocopy");
  });
}

void Hdf5Writer::close() {
  open_->write([&] {
    must(H5Fflush(*open_->file, H5F_SCOPE_LOCAL), "H5Fflush");
    must(open_->file->close(), "H5Fclose");
  });
}

}  // namespace salbench
