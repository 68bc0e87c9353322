// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/hdf5/hdf5_writer.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <optional>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "io/file.h"
#include "io/hdf5/hdf5_library.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

using namespace hdf5;

// Opens or makes the group or data set of that name.
Handle opened_object(hid_t file, hid_t links, const std::string& name) {
  if (H5Lexists(file, name.c_str(), H5P_DEFAULT) > 0)
    return {H5Oopen(file, name.c_str(), H5P_DEFAULT), H5Oclose, "H5Oopen"};
  const Handle properties = property_list(H5P_GROUP_CREATE);
  must(H5Pset_obj_track_times(properties, false), "H5Pset_obj_track_times");
  return {H5Gcreate2(file, name.c_str(), links, properties, H5P_DEFAULT), H5Gclose, "H5Gcreate"};
}

// --- tables: rows as records of fixed size, fields packed one behind the other, text filled up with zeros

struct Field {
  std::string name;
  std::size_t type = 0;    // the alternative of Cell
  std::size_t size = 1;    // bytes: 8 of a number; of text those of the longest cell, at least 1
  std::size_t offset = 0;  // bytes from the begin of the record
};

// A column without cells is text. Throws std::logic_error for one that mixes types.
Field field_of(const Table& table, std::size_t column, std::size_t offset) {
  Field field{.name = table.columns[column], .offset = offset};
  for (const auto& row : table.rows) {
    const Cell& cell = row.at(column);
    field.type = table.rows.front().at(column).index();
    if (cell.index() != field.type)
      throw std::logic_error(fmt::format("the column {} mixes types", field.name));
    const auto* text = std::get_if<std::string>(&cell);
    field.size = std::max(field.size, text != nullptr ? text->size() : sizeof(double));
  }
  return field;
}

void put(std::byte* place, const std::string& text) { std::memcpy(place, text.data(), text.size()); }
template <class Number>
void put(std::byte* place, Number number) {
  std::memcpy(place, &number, sizeof number);
}

void write_table(hid_t file, hid_t links, const Hdf5Table& table) {
  std::vector<Field> fields;
  std::size_t record = 0;  // bytes
  for (std::size_t c = 0; c < table.table.columns.size(); ++c) {
    fields.push_back(field_of(table.table, c, record));
    record += fields.back().size;
  }
  const Handle type(H5Tcreate(H5T_COMPOUND, record), H5Tclose, "H5Tcreate");
  for (const Field& field : fields) {
    const Handle text = string_type(field.size);
    const hid_t of_cell[] = {text, type_of<std::int64_t>(), type_of<double>()};
    must(H5Tinsert(type, field.name.c_str(), field.offset, of_cell[field.type]), "H5Tinsert");
  }
  const hsize_t rows = table.table.rows.size();
  std::vector<std::byte> records(rows * record);
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t c = 0; c < fields.size(); ++c)
      std::visit([place = &records[r * record + fields[c].offset]](const auto& cell) { put(place, cell); },
                 table.table.rows[r][c]);
  const Handle space(H5Screate_simple(1, &rows, nullptr), H5Sclose, "H5Screate_simple");
  const Handle properties = property_list(H5P_DATASET_CREATE);
  must(H5Pset_obj_track_times(properties, false), "H5Pset_obj_track_times");
  const Handle set(H5Dcreate2(file, table.name.c_str(), type, space, links, properties, H5P_DEFAULT),
                   H5Dclose, "H5Dcreate");
  if (rows > 0) must(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, records.data()), "H5Dwrite");
  write_attribute(set, "description", table.description);
}

// --- a file on a disk that may be full

// The library crashes if a write fails, at once or when it closes the file (1.10.8). So this driver keeps the
// first error to itself, writes nothing from there on, and the writer asks for it after every step.
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
#ifdef H5FD_CLASS_VERSION  // HDF5 1.14 and later
    functions.version = H5FD_CLASS_VERSION;
    functions.value = 256;  // the first number that the library does not keep for itself
#endif
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
    open_->links.emplace(groups_between());
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

void Hdf5Writer::array(const Array& array) { this->array({array.name, pack(array)}); }

void Hdf5Writer::array(const NamedArray& array) {
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

void Hdf5Writer::close() {
  open_->write([&] {
    must(H5Fflush(*open_->file, H5F_SCOPE_LOCAL), "H5Fflush");
    must(open_->file->close(), "H5Fclose");
  });
}

}  // namespace salbench
