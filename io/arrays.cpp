// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/arrays.h"

#include <functional>
#include <numeric>

namespace salbench {

std::size_t Array::count() const {
  return std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>());
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
