// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/hdf5/hdf5_writer.h"

#include <algorithm>
#include <cstring>
#include <optional>

#include <fmt/format.h>

#include "io/file.h"
#include "io/hdf5/hdf5_driver.h"
#include "io/hdf5/hdf5_library.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

using namespace hdf5;

// Opens or creates the group or data set of that name.
Handle opened_object(hid_t file, hid_t links, const std::string& name) {
  if (H5Lexists(file, name.c_str(), H5P_DEFAULT) > 0)
    return {H5Oopen(file, name.c_str(), H5P_DEFAULT), H5Oclose, "H5Oopen"};
  const Handle properties = property_list(H5P_GROUP_CREATE);
  must(H5Pset_obj_track_times(properties, false), "H5Pset_obj_track_times");
  return {H5Gcreate2(file, name.c_str(), links, properties, H5P_DEFAULT), H5Gclose, "H5Gcreate"};
}

// --- tables: rows as fixed-size records, fields packed, text padded with zeros ----------------------------

struct Field {
  std::string name;
  std::size_t type = 0;    // index of the alternative of Cell
  std::size_t size = 1;    // bytes: 8 for a number; for text its longest cell, at least 1
  std::size_t offset = 0;  // bytes from the start of the record
};

// A column without cells is text. Throws std::logic_error for mixed types.
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

}  // namespace

struct Hdf5Writer::Open {
  explicit Open(const std::filesystem::path& path) : folder(path.parent_path().string()), disk(path) {}

  std::string folder;
  Disk disk;
  std::optional<Handle> file = {}, links = {};

  template <class Action>
  void write(const Action& action) {
    const auto lock = library();
    std::string failure;
    try {
      if (disk.error() == 0) action();
    } catch (const std::runtime_error& error) {
      failure = error.what();
    }
    if (disk.error() != 0) failure = system_reason(disk.error());
    if (!failure.empty()) throw StorageError(fmt::format("{}: cannot be written to: {}", folder, failure));
  }
};

Hdf5Writer::Hdf5Writer(const std::filesystem::path& path) : open_(std::make_unique<Open>(path)) {
  open_->write([&] {
    open_->file.emplace(created_on(open_->disk, file_creation()));
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
