// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers and columns of the layouts of values, written and read back.
#pragma once

#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "io/arrays.h"
#include "stages/core/errors.h"

namespace salbench {

template <class T>
Array scalar(const char* name, T value, const char* unit, const char* description) {
  return {name, {}, std::vector<T>{value}, unit, description};
}

template <class T>
const std::vector<T>& values_of(const Arrays& arrays, std::string_view name) {
  const Array* array = find_array(arrays, name);
  if (array == nullptr) throw InputError(fmt::format("the data set '{}' is missing", name));
  const auto* values = std::get_if<std::vector<T>>(&array->values);
  if (values == nullptr) throw InputError(fmt::format("the data set '{}' has another type", name));
  return *values;
}

template <class T>
T scalar_of(const Arrays& arrays, std::string_view name) {
  const auto& values = values_of<T>(arrays, name);
  if (values.size() != 1) throw InputError(fmt::format("the data set '{}' is not one number", name));
  return values[0];
}

}  // namespace salbench
