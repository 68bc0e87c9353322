// The header of a PLY file: what the elements of its body consist of. [turk1994]
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/text_scanner.h"

namespace salbench::ply {

enum class Encoding { ascii, little_endian, big_endian };

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct Property {
  std::string name;
  Type type;                        // of the value, or of each member of the list
  std::optional<Type> length_type;  // only of a list
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

// Reads up to and with "end_header"; the body is then in.text_after_line(). Throws InputError.
Header read_header(TextScanner& in);

}  // namespace salbench::ply
