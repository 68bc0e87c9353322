// SPDX-License-Identifier: GPL-3.0-or-later
// The header of a PLY file: what the elements of its body consist of. [turk1994]
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "io/shapes/text_scanner.h"

namespace salbench::ply {

enum class Encoding { ascii, little_endian, big_endian };

// A type of number, given by a value of it.
using Type = std::variant<std::int8_t, std::uint8_t, std::int16_t, std::uint16_t, std::int32_t, std::uint32_t,
                          float, double>;

struct Property {
  std::string name;
  Type type;                        // of the value, or of each member of the list
  std::optional<Type> length_type;  // of a list only
};

struct Element {
  std::string name;
  std::int64_t count;
  std::vector<Property> properties;

  const Property* find(std::string_view property) const;  // nullptr if there is none
};

struct Header {
  Encoding encoding;
  std::vector<Element> elements;  // in the order of the body

  const Element* find(std::string_view element) const;
};

// Reads up to and with "end_header"; the body is then in.text_after_line(). The scanner takes line ends as in
// the first line: the bytes of a binary body could pass for one. Throws InputError.
Header read_header(TextScanner& in);

}  // namespace salbench::ply
