// SPDX-License-Identifier: GPL-3.0-or-later
// Reads exported files with the HDF5 library itself.
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#define H5_USE_110_API  // also supported by newer libraries
#include <hdf5.h>

#include "io/arrays.h"

namespace salbench {

class ExportedFile {
 public:
  explicit ExportedFile(const std::filesystem::path& path)
      : file_(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT)) {}
  ExportedFile(const ExportedFile&) = delete;
  ExportedFile& operator=(const ExportedFile&) = delete;
  ~ExportedFile() { H5Fclose(file_); }

  // Names of the numeric data sets, sorted; external links are not followed.
  std::vector<std::string> arrays() const {
    std::vector<std::string> names;
    const auto add = [](hid_t file, const char* name, const H5O_info_t* info, void* all) -> herr_t {
      if (info->type != H5O_TYPE_DATASET) return 0;
      const hid_t set = H5Dopen2(file, name, H5P_DEFAULT), type = H5Dget_type(set);
      if (H5Tget_class(type) == H5T_INTEGER || H5Tget_class(type) == H5T_FLOAT)
        static_cast<std::vector<std::string>*>(all)->emplace_back(name);
      H5Tclose(type);
      H5Dclose(set);
      return 0;
    };
    H5Ovisit2(file_, H5_INDEX_NAME, H5_ITER_INC, add, &names, H5O_INFO_BASIC);
    std::ranges::sort(names);
    return names;
  }

  Array read(const std::string& name) const {
    const hid_t set = H5Dopen2(file_, name.c_str(), H5P_DEFAULT), type = H5Dget_type(set),
                space = H5Dget_space(set);
    std::vector<hsize_t> extents(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space)));
    H5Sget_simple_extent_dims(space, extents.data(), nullptr);
    Array array{name, {extents.begin(), extents.end()}, {}, {}, {}};
    const auto try_type = [&]<class T>(hid_t stored, T) {
      if (H5Tequal(type, stored) <= 0) return;
      std::vector<T> values(array.count());
      H5Dread(set, stored, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
      array.values = std::move(values);
    };
    try_type(H5T_IEEE_F64LE, double{});
    try_type(H5T_IEEE_F32LE, float{});
    try_type(H5T_STD_I32LE, std::int32_t{});
    try_type(H5T_STD_I64LE, std::int64_t{});
    try_type(H5T_STD_U8LE, std::uint8_t{});
    H5Sclose(space);
    H5Tclose(type);
    H5Dclose(set);
    return array;
  }

 private:
  hid_t file_;
};

}  // namespace salbench
