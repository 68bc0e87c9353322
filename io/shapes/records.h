// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the records of a shape file by a schema, from text or from bytes. The readers of PLY, PCD and OFF
// turn their headers into a schema, and leave the rest to this one. It reads to the end of the last record,
// so a truncated file is detected wherever it ends.
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
  char kind = 'f';  // i: whole, u: not negative, f: floating-point
  std::size_t bytes = 4;
};

// "int32" and what else it is called: "i4" in .npy, "int" in PLY.
struct NumberName {
  std::string_view name, in_npy, in_ply;  // the last is empty where PLY has no such type

  NumberType type() const { return {in_npy[0], static_cast<std::size_t>(in_npy[1] - '0')}; }
};
inline constexpr std::array kNumberNames = {
    NumberName{"int8", "i1", "char"},     NumberName{"uint8", "u1", "uchar"},
    NumberName{"int16", "i2", "short"},   NumberName{"uint16", "u2", "ushort"},
    NumberName{"int32", "i4", "int"},     NumberName{"uint32", "u4", "uint"},
    NumberName{"float32", "f4", "float"}, NumberName{"float64", "f8", "double"},
    NumberName{"int64", "i8", ""},        NumberName{"uint64", "u8", ""},
    NumberName{"float16", "f2", ""}};

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
      return is_real ? use(Eigen::half{}) : has_sign ? use(std::int16_t{}) : use(std::uint16_t{});
    case 4:
      return is_real ? use(float{}) : has_sign ? use(std::int32_t{}) : use(std::uint32_t{});
    default:
      return is_real ? use(double{}) : has_sign ? use(std::int64_t{}) : use(std::uint64_t{});
  }
}

struct Column {
  std::string name;
  NumberType type = {};
  std::int64_t count = 1;                 // values in each record; none take no bytes
  std::optional<NumberType> length = {};  // of a list, and is written before it: in place of the count
};

struct Records {
  std::string name;  // "vertex"
  std::int64_t count = 0;
  std::vector<Column> columns = {};

  // The first column of that name; nullptr if there is none, or it is not one number, or no list.
  const Column* number(std::string_view column) const;
  const Column* list(std::string_view column) const;
  std::string one() const;     // "vertex", "element \"camera\""
  std::string plural() const;  // "vertices"
};

enum class Encoding {
  text,           // a record takes one line, several whole ones, or a part of one
  little_endian,  // record after record
  big_endian,
  columns  // column after column, little endian, and no lists
};

struct Schema {
  Encoding encoding = Encoding::text;
  std::vector<Records> records = {};       // in the order of the body
  std::string_view padding = " \r\n";      // what may follow the last of them, in bytes
  bool whole_numbers_have_points = false;  // in text: "3.0" is 3
  // In text: colours and whatever else stand behind a record. No file announces them reliably, and only the
  // line's end tells where they stop, so each of the records begins a line.
  bool further_columns = false;

  const Records* find(std::string_view records) const;
};

// Both read what follows the line of `in`, and throw InputError: of text "NAME:LINE: what is wrong", of bytes
// with number and place of the record.

// Vertices, which have numbers x, y and z; and faces, where there are any, by the list `corners`.
Mesh read_mesh_records(const TextScanner& in, const Schema& schema, const Column* corners,
                       PolygonCounts* counts);

// Points by the names of x, y and z, which they have, and of their normals, which they may have; and the
// viewpoint of a record "camera" that knows one. The body is that of `in`, or what was packed there.
PointCloud read_cloud_records(const TextScanner& in, std::string_view body, const Schema& schema,
                              const Records& points, const std::array<std::string_view, 6>& numbers);

// Nothing for the origin, which stands where no viewpoint is known; but one camera saw a cloud in rows.
std::optional<Vec3> known_viewpoint(const Vec3& written, double rows);

// Throws InputError unless these bytes behind the last record are padding.
void require_end(std::string_view rest, const Records& last, const TextScanner& in, const Schema& schema);

}  // namespace salbench
