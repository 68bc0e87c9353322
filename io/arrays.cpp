// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/arrays.h"

#include <algorithm>
#include <functional>
#include <numeric>

#include <fmt/format.h>

#include "stages/core/errors.h"

namespace salbench {

std::size_t Array::count() const {
  return std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>());
}

bool is_one_per_point(const std::vector<std::size_t>& shape) {
  return std::ranges::count_if(shape, [](std::size_t extent) { return extent != 1; }) <= 1;
}

void refuse_beyond_doubles(std::string_view number) {
  throw InputError(fmt::format("it holds {}: whole numbers beyond 2^53 cannot be used, scale them", number));
}

ScalarField point_values(const Array& array) {
  if (!is_one_per_point(array.shape))
    throw InputError(
        fmt::format("its shape is ({}), expected one value per point", fmt::join(array.shape, ", ")));
  return std::visit(
      [](const auto& values) {
        ScalarField result;
        result.reserve(values.size());
        for (const auto value : values) result.push_back(exact_double(value));
        return result;
      },
      array.values);
}

const Array* find_array(const Arrays& arrays, std::string_view name) {
  for (const Array& array : arrays)
    if (array.name == name) return &array;
  return nullptr;
}

const AttributeValue* find_attribute(const Attributes& attributes, std::string_view name) {
  for (const auto& [key, value] : attributes)
    if (key == name) return &value;
  return nullptr;
}

}  // namespace salbench
