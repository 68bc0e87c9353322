// SPDX-License-Identifier: GPL-3.0-or-later
// Reads arrays of a file in the HDF5 form, and reports which one is wrong and how.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <fmt/format.h>

#include "io/arrays.h"
#include "io/shapes/mesh_parts.h"
#include "io/shapes/text_scanner.h"
#include "stages/core/errors.h"
#include "stages/core/field.h"

namespace salbench {

inline constexpr const char* kSourceLength = "length unit of the source";

// File content with the start of error messages.
struct FormReader {
  std::string_view name;
  const Arrays& arrays;

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(fmt::format("{}: {}", name, what));
  }
  [[noreturn]] void fail(const Array& array, const std::string& what) const {
    fail(fmt::format("data set {}: {}", in_quotes(array.name), what));
  }

  bool has(std::string_view array) const { return find_array(arrays, array) != nullptr; }

  // Array of rows x columns numbers; rows = 0: any number.
  template <class T>
  const std::vector<T>& read(std::string_view array_name, std::size_t rows, std::size_t columns = 0) const {
    const Array* array = find_array(arrays, array_name);
    if (array == nullptr)
      fail(fmt::format("has no data set {}: import the set again", in_quotes(std::string(array_name))));
    const auto* values = std::get_if<std::vector<T>>(&array->values);
    if (values == nullptr)
      fail(*array, std::is_same_v<T, double> ? std::string("expected numbers of type float64")
                                             : fmt::format("expected whole numbers of type {}int{}",
                                                           std::is_unsigned_v<T> ? "u" : "", 8 * sizeof(T)));
    const std::size_t dimensions = columns == 0 ? 1 : 2;
    if (array->shape.size() != dimensions || (rows != 0 && array->shape[0] != rows) ||
        (columns != 0 && array->shape[1] != columns))
      fail(*array, fmt::format("its shape is ({}), expected ({}{})", fmt::join(array->shape, ", "),
                               rows == 0 ? "n" : std::to_string(rows),
                               columns == 0 ? "" : fmt::format(", {}", columns)));
    return *values;
  }

  std::vector<Vec3> vectors(std::string_view array_name, std::size_t rows) const {
    const std::vector<double>& values = read<double>(array_name, rows, 3);
    std::vector<Vec3> all(values.size() / 3);
    for (std::size_t i = 0; i < all.size(); ++i) {
      all[i] = Vec3(values[3 * i], values[3 * i + 1], values[3 * i + 2]);
      if (const std::string_view wrong = wrong_with_point(all[i]); !wrong.empty())
        fail(*find_array(arrays, array_name), fmt::format("row {} (0-based): {}", i, wrong));
    }
    return all;
  }

  // Indices of points, less than n.
  void check_indices(std::string_view array_name, std::span<const std::int32_t> indices,
                     std::size_t n) const {
    for (const std::int32_t i : indices)
      if (i < 0 || static_cast<std::size_t>(i) >= n)
        fail(fmt::format("data set {}: {} is out of range: there are {} points, numbered from 0",
                         in_quotes(std::string(array_name)), i, n));
  }

  ScalarField values(std::string_view array_name, std::size_t n) const {
    const ScalarField& values = read<double>(array_name, n);
    check_values(array_name, values);
    return values;
  }
  void check_values(std::string_view array_name, std::span<const double> values) const {
    if (const std::string wrong = wrong_with_values(values, true); !wrong.empty())
      fail(fmt::format("data set {}: {}", in_quotes(std::string(array_name)), wrong));
  }
};

}  // namespace salbench
