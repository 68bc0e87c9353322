// SPDX-License-Identifier: GPL-3.0-or-later
// Named, typed, shaped arrays with their units: what a file holds, free of any file format.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace salbench {

// In an order that content digests contain: new types come last.
using ArrayValues = std::variant<std::vector<double>, std::vector<float>, std::vector<std::int32_t>,
                                 std::vector<std::int64_t>, std::vector<std::uint8_t>>;

struct Array {
  std::string name;                // unique; "group/name" nests
  std::vector<std::size_t> shape;  // product = number of values; row major; empty: one scalar
  ArrayValues values;
  std::string unit;  // "1" if there is none
  std::string description;
  bool repetitive = false;  // deflate halves it at least, although it is not single precision

  std::size_t count() const;
};

using Arrays = std::vector<Array>;

const Array* find_array(const Arrays& arrays, std::string_view name);  // nullptr if there is none

using AttributeValue = std::variant<std::string, double, std::int64_t>;
using Attributes = std::vector<std::pair<std::string, AttributeValue>>;  // in the order they are written

const AttributeValue* find_attribute(const Attributes& attributes, std::string_view name);

}  // namespace salbench
