// SPDX-License-Identifier: GPL-3.0-or-later
// Named, typed, shaped arrays with units: the contents of a file, independent of any file format.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "stages/core/types.h"

namespace salbench {

// New types are appended: content digests contain the index.
using ArrayValues = std::variant<std::vector<double>, std::vector<float>, std::vector<std::int32_t>,
                                 std::vector<std::int64_t>, std::vector<std::uint8_t>>;

struct Array {
  std::string name;                // unique; "group/name" nests
  std::vector<std::size_t> shape;  // row major; product = number of values; empty: one scalar
  ArrayValues values;
  std::string unit;  // "1" if dimensionless
  std::string description;
  bool repetitive = false;  // deflate at least halves it, although it is not single precision

  std::size_t count() const;
};

using Arrays = std::vector<Array>;

// Array of n x 3 numbers; array of n numbers.
template <class Triple>
Array triples(std::string name, const std::vector<Triple>& rows, std::string unit, std::string description) {
  static_assert(sizeof(Triple) == 3 * sizeof(typename Triple::value_type));
  std::vector<typename Triple::value_type> flat(rows.size() * 3);
  if (!rows.empty()) std::memcpy(flat.data(), rows.front().data(), rows.size() * sizeof(Triple));
  return {std::move(name), {rows.size(), 3}, std::move(flat), std::move(unit), std::move(description)};
}
template <class T>
Array column(std::string name, std::vector<T> values, std::string unit, std::string description) {
  const std::size_t n = values.size();
  return {std::move(name), {n}, std::move(values), std::move(unit), std::move(description)};
}

// File layout of a T: its name `kind`, and the functions `Arrays arrays(const T&)` and `T read(const
// Arrays&)`. Defined for each type that a rule computes.
template <class T>
struct ArrayForm;

const Array* find_array(const Arrays& arrays, std::string_view name);  // nullptr if absent

using AttributeValue = std::variant<std::string, double, std::int64_t>;
using Attributes = std::vector<std::pair<std::string, AttributeValue>>;  // in the order of writing

const AttributeValue* find_attribute(const Attributes& attributes, std::string_view name);

}  // namespace salbench
