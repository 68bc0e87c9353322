// SPDX-License-Identifier: GPL-3.0-or-later
// MAT files of version 5 for tests, written by the library that reads them.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <matio.h>

namespace salbench {

class MatWriter {
 public:
  explicit MatWriter(const std::filesystem::path& path, mat_ft version = MAT_FT_MAT5)
      : file_(Mat_CreateVer(path.c_str(), nullptr, version)) {
    if (file_ == nullptr) throw std::runtime_error("no MAT file");
  }
  MatWriter(const MatWriter&) = delete;
  MatWriter& operator=(const MatWriter&) = delete;
  ~MatWriter() { Mat_Close(file_); }

  // A column of doubles.
  void write(const char* name, std::vector<double> values) {
    write(matrix(name, MAT_C_DOUBLE, MAT_T_DOUBLE, values));
  }
  // A matrix of doubles, column by column.
  void write(const char* name, std::size_t rows, std::size_t columns, std::vector<double> values) {
    std::array<std::size_t, 2> size = {rows, columns};
    write(Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size.data(), values.data(), 0));
  }
  template <class Number>
  void write(const char* name, matio_classes class_type, matio_types type, std::vector<Number> values) {
    write(matrix(name, class_type, type, values));
  }

  // rows x columns cells of doubles, column by column.
  void write_cells(const char* name, std::size_t rows, std::size_t columns,
                   std::vector<std::vector<double>> cells) {
    std::array<std::size_t, 2> size = {rows, columns};
    matvar_t* array = Mat_VarCreate(name, MAT_C_CELL, MAT_T_CELL, 2, size.data(), nullptr, 0);
    for (std::size_t i = 0; i < cells.size(); ++i)
      Mat_VarSetCell(array, static_cast<int>(i), matrix(nullptr, MAT_C_DOUBLE, MAT_T_DOUBLE, cells[i]));
    write(array);
  }

 private:
  template <class Number>
  static matvar_t* matrix(const char* name, matio_classes class_type, matio_types type,
                          std::vector<Number>& values) {
    std::array<std::size_t, 2> size = {values.size(), 1};
    return Mat_VarCreate(name, class_type, type, 2, size.data(), values.data(), 0);
  }
  void write(matvar_t* variable) {
    Mat_VarWrite(file_, variable, MAT_COMPRESSION_ZLIB);
    Mat_VarFree(variable);
  }

  mat_t* file_;
};

}  // namespace salbench
