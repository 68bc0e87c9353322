// SPDX-License-Identifier: GPL-3.0-or-later
// Both directions of a value's layout: one function lists its fields for writing and reading.
#pragma once

#include <algorithm>
#include <cstring>
#include <functional>
#include <numeric>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/arrays.h"
#include "stages/core/errors.h"

namespace salbench {

using Extents = std::vector<std::size_t>;

template <class T>
concept Triple = requires {
  typename T::value_type;
}
&&sizeof(T) == 3 * sizeof(typename T::value_type);

// Arrays of a value. `unit` and `description` are those of Array.
class FieldsOut {
 public:
  Arrays arrays = {};

  template <class T>
  void number(const char* name, T value, const char* unit, const char* description) {
    arrays.push_back({name, {}, std::vector<T>{value}, unit, description});
  }
  // n values, or n x 3 for triples.
  template <class T>
  void column(const char* name, const std::vector<T>& values, const char* unit, const char* description) {
    if constexpr (Triple<T>)
      arrays.push_back(triples(name, values, unit, description));
    else
      arrays.push_back(salbench::column(name, values, unit, description));
  }
  // n x columns values, row by row.
  template <class T>
  void table(const char* name, const std::vector<T>& values, std::size_t columns, const char* unit,
             const char* description) {
    array(name, values, {columns == 0 ? 0 : values.size() / columns, columns}, unit, description);
  }
  // A vector or array whose size is the product of the shape.
  template <class Values>
  void array(const char* name, const Values& values, Extents shape, const char* unit, const char* description,
             bool repetitive = false) {
    std::vector<typename Values::value_type> all(values.begin(), values.end());
    arrays.push_back({name, std::move(shape), std::move(all), unit, description, repetitive});
  }
  void width(const char*, std::size_t) {}
  bool holds(const char*, bool is_there) { return is_there; }
};

// A value from arrays. All members throw InputError if an array is missing, or has a wrong type or size.
class FieldsIn {
 public:
  explicit FieldsIn(const Arrays& arrays) : arrays_(arrays) {}

  template <class T>
  void number(const char* name, T& value, const char*, const char*) const {
    value = sized<T>(name, 1)[0];
  }
  template <class T>
  void column(const char* name, std::vector<T>& values, const char*, const char*) const {
    if constexpr (Triple<T>) {
      const auto& flat = rows<typename T::value_type>(name, 3);
      values.resize(flat.size() / 3);
      if (!values.empty())
        std::memcpy(static_cast<void*>(values.data()), flat.data(), sizeof(T) * values.size());
    } else {
      values = all<T>(name);
    }
  }
  template <class T>
  void table(const char* name, std::vector<T>& values, std::size_t columns, const char*, const char*) const {
    values = rows<T>(name, columns);
  }
  template <class Values>
  void array(const char* name, Values& values, const Extents& shape, const char*, const char*,
             bool = false) const {
    const auto count = std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>());
    const auto& found = sized<typename Values::value_type>(name, count);
    if constexpr (requires { values.assign(found.begin(), found.end()); })
      values.assign(found.begin(), found.end());
    else
      std::ranges::copy(found, values.begin());
  }
  // Last extent of an array, which other arrays share.
  void width(const char* name, std::size_t& columns) const {
    const Extents& shape = array_of(name).shape;
    if (shape.empty()) throw InputError(fmt::format("the data set '{}' is a single number", name));
    columns = shape.back();
  }
  bool holds(const char* name, bool) const { return find_array(arrays_, name) != nullptr; }

 private:
  const Array& array_of(std::string_view name) const {
    const Array* array = find_array(arrays_, name);
    if (array == nullptr) throw InputError(fmt::format("the data set '{}' is missing", name));
    return *array;
  }
  template <class T>
  const std::vector<T>& all(std::string_view name) const {
    const auto* values = std::get_if<std::vector<T>>(&array_of(name).values);
    if (values == nullptr) throw InputError(fmt::format("the data set '{}' has another type", name));
    return *values;
  }
  template <class T>
  const std::vector<T>& sized(std::string_view name, std::size_t count) const {
    const auto& values = all<T>(name);
    if (values.size() != count)
      throw InputError(
          fmt::format("the data set '{}' has {} values, expected {}", name, values.size(), count));
    return values;
  }
  template <class T>
  const std::vector<T>& rows(std::string_view name, std::size_t columns) const {
    const auto& values = all<T>(name);
    if (columns == 0 ? !values.empty() : values.size() % columns != 0)
      throw InputError(fmt::format("the data set '{}' is not n x {}", name, columns));
    return values;
  }

  const Arrays& arrays_;
};

// Type of the value passed to a visitor: const when writing.
template <class Visitor>
inline constexpr bool kReads = std::is_same_v<Visitor, FieldsIn>;
template <class Visitor, class T>
using Visited = std::conditional_t<kReads<Visitor>, T, const T>;

}  // namespace salbench
