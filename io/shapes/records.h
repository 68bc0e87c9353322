// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the records of a shape file by a schema, from text or binary data. The readers of PLY and OFF
// translate their headers into a schema. Everything up to the end of the last record is read, so that
// truncation is detected at any position.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/shapes/polygons.h"
#include "io/shapes/text_scanner.h"
#include "stages/core/types.h"
#include "stages/geometry/point_cloud.h"

namespace salbench {

static_assert(std::endian::native == std::endian::little, "numbers are read as they lie in the file");

struct NumberType {
  char kind = 'f';  // i: signed integer, u: unsigned, f: floating-point
  std::size_t bytes = 4;
};

// PLY type with both of its names.
struct NumberName {
  std::string_view name, sized;
  NumberType type;
};
inline constexpr std::array kNumberNames = {
    NumberName{"char", "int8", {'i', 1}},     NumberName{"uchar", "uint8", {'u', 1}},
    NumberName{"short", "int16", {'i', 2}},   NumberName{"ushort", "uint16", {'u', 2}},
    NumberName{"int", "int32", {'i', 4}},     NumberName{"uint", "uint32", {'u', 4}},
    NumberName{"float", "float32", {'f', 4}}, NumberName{"double", "float64", {'f', 8}}};

template <class Number>
Number number_at(const char* bytes, bool swapped) {
  std::array<char, sizeof(Number)> raw;
  std::memcpy(raw.data(), bytes, raw.size());
  if (swapped) std::ranges::reverse(raw);
  return std::bit_cast<Number>(raw);
}

// Calls `use` with a zero of that type.
template <class Use>
auto with_type(const NumberType& type, const Use& use) {
  const bool is_real = type.kind == 'f', has_sign = type.kind == 'i';
  switch (type.bytes) {
    case 1:
      return has_sign ? use(std::int8_t{}) : use(std::uint8_t{});
    case 2:
      return has_sign ? use(std::int16_t{}) : use(std::uint16_t{});
    case 4:
      return is_real ? use(float{}) : has_sign ? use(std::int32_t{}) : use(std::uint32_t{});
    default:
      return use(double{});
  }
}

struct Column {
  std::string name;
  NumberType type = {};
  std::optional<NumberType> length = {};  // set for lists: type of the length that precedes the list
};

struct Records {
  std::string name;  // "vertex"
  std::int64_t count = 0;
  std::vector<Column> columns = {};

  // First matching column; nullptr if there is none, or if it is not a number or a list, respectively.
  const Column* number(std::string_view column) const;
  const Column* list(std::string_view column) const;
  std::string one() const;     // "vertex", "element \"camera\""
  std::string plural() const;  // "vertices"
};

enum class Encoding {
  text,           // one record per line, several, or a part of one
  little_endian,  // binary records in sequence
  big_endian
};

struct Schema {
  Encoding encoding = Encoding::text;
  std::vector<Records> records = {};       // in the order of the body
  bool whole_numbers_have_points = false;  // in text: "3.0" is 3
  // In text: colours and other data after a record. No file announces them reliably, and only the end of the
  // line ends them, so each record starts on a new line.
  bool further_columns = false;

  const Records* find(std::string_view records) const;
};

// Both read from the line after `in` and throw InputError: "NAME:LINE: problem" for text, number and position
// of the record for binary data.

// Vertices from numbers x, y and z; faces, if any, from the list `corners`.
Mesh read_mesh_records(const TextScanner& in, const Schema& schema, const Column* corners,
                       PolygonCounts* counts);

// Vertices as points, with normals if present, and the viewpoint from a record "camera" if it is known.
PointCloud read_cloud_records(const TextScanner& in, const Schema& schema);

}  // namespace salbench
