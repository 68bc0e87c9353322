// SPDX-License-Identifier: GPL-3.0-or-later
// The header of a PCD file says what its points consist of. Binary bodies hold a point after the other;
// compressed ones hold a field after the other, as one block of LZF. [rusu2011]
#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include <fmt/format.h>
#include <lzf.h>

#include "io/file.h"
#include "io/shapes/cloud_file.h"
#include "io/shapes/mesh_parts.h"
#include "io/shapes/records.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

constexpr std::int64_t kMaxCount = 100'000;  // values of one field: histograms have some hundreds
constexpr std::size_t kMaxFields = 10'000;

std::int64_t whole_number(TextScanner& in, std::int64_t least, std::int64_t most) {
  const std::int64_t number = in.integer();
  if (number < least || number > most)
    in.fail(fmt::format("{} is not between {} and {}", number, least, most));
  return number;
}

void read_field_size(TextScanner& in, Column& field) {
  field.type.bytes = static_cast<std::size_t>(whole_number(in, 1, 8));
  if (!std::has_single_bit(field.type.bytes))
    in.fail(fmt::format("a value of {} bytes: 1, 2, 4 and 8 can be read", field.type.bytes));
}

void read_field_type(TextScanner& in, Column& field) {
  const std::string_view word = in.word();
  if (word != "I" && word != "U" && word != "F")
    in.fail(fmt::format("{} is not a PCD type: expected I, U or F", in_quotes(word)));
  field.type.kind = static_cast<char>(word[0] - 'A' + 'a');
}

void read_field_count(TextScanner& in, Column& field) { field.count = whole_number(in, 0, kMaxCount); }

std::vector<Column> read_field_names(TextScanner& in) {
  std::vector<Column> fields;
  while (!in.at_line_end()) fields.push_back({.name = std::string(in.word())});
  if (fields.size() > kMaxFields)
    in.fail(fmt::format("{} fields: at most {} can be read", fields.size(), kMaxFields));
  return fields;
}

// One word per field.
void read_each(TextScanner& in, std::vector<Column>& fields, void (*read)(TextScanner&, Column&)) {
  if (fields.empty()) in.fail("the line stands before FIELDS");
  for (Column& field : fields) read(in, field);
  if (!in.at_line_end()) in.fail(fmt::format("the line has more values than the {} fields", fields.size()));
}

Encoding pcd_encoding(TextScanner& in) {
  const std::string_view word = in.word();
  if (word == "ascii") return Encoding::text;
  if (word == "binary") return Encoding::little_endian;
  if (word == "binary_compressed") return Encoding::columns;
  in.fail(
      fmt::format("{} is not a PCD format: expected ascii, binary or binary_compressed", in_quotes(word)));
}

struct PcdHeader {
  Schema schema{.records = {{.name = "point"}}, .padding = {"\0 \r\n", 4}};
  std::optional<std::int64_t> width, height, points;
  Vec3 viewpoint = Vec3::Zero();  // its rotation turns nothing that is read here
};

// Up to and with the line DATA.
PcdHeader read_pcd_lines(TextScanner& in) {
  PcdHeader header;
  std::vector<Column>& fields = header.schema.records[0].columns;
  while (in.next_filled_line()) {
    const std::string_view keyword = in.word();
    if (keyword == "FIELDS" || keyword == "COLUMNS") {
      fields = read_field_names(in);
    } else if (keyword == "SIZE") {
      read_each(in, fields, read_field_size);
    } else if (keyword == "TYPE") {
      read_each(in, fields, read_field_type);
    } else if (keyword == "COUNT") {
      read_each(in, fields, read_field_count);
    } else if (keyword == "WIDTH") {
      header.width = whole_number(in, 0, kMaxVertices);
    } else if (keyword == "HEIGHT") {
      header.height = whole_number(in, 0, kMaxVertices);
    } else if (keyword == "POINTS") {
      header.points = whole_number(in, 0, kMaxVertices);
    } else if (keyword == "VIEWPOINT") {
      for (double& coordinate : header.viewpoint) coordinate = in.number();
    } else if (keyword == "DATA") {
      header.schema.encoding = pcd_encoding(in);
      in.end_header();
      return header;
    } else if (keyword != "VERSION") {
      in.fail(fmt::format("{} is not a keyword of a PCD header", in_quotes(keyword)));
    }
  }
  in.fail("the file ends within the header: it is cut short, or not a PCD file");
}

std::int64_t points_of(const PcdHeader& header, const TextScanner& in) {
  const auto& [width, height, points] = std::tie(header.width, header.height, header.points);
  if (!width && !points) in.fail("the header has neither WIDTH nor POINTS");
  const std::int64_t rows = height.value_or(1), size = width ? *width * rows : *points;  // both below 2^31
  if (points && size != *points)
    in.fail(fmt::format("the header announces {} points, and {} x {}", *points, *width, rows));
  if (const std::string wrong = wrong_with_count(size, "points"); !wrong.empty()) in.fail(wrong);
  return size;
}

PcdHeader read_pcd_header(TextScanner& in) {
  PcdHeader header = read_pcd_lines(in);
  Records& points = header.schema.records[0];
  points.count = points_of(header, in);
  for (const auto& [name, type, count, _] : points.columns)
    if (type.kind == 'f' && type.bytes < 4 && count > 0)
      in.fail(
          fmt::format("field {}: floating point of {} bytes cannot be read", in_quotes(name), type.bytes));
  for (const char* axis : {"x", "y", "z"})
    if (points.number(axis) == nullptr)
      in.fail(fmt::format("the header has no field \"{}\" of one number per point", axis));
  if (points.count == 0) in.fail("the header announces no points");
  return header;
}

std::int64_t bytes_per_point(const Records& points) {
  std::int64_t sum = 0;
  for (const Column& field : points.columns) sum += static_cast<std::int64_t>(field.type.bytes) * field.count;
  return sum;
}

// The block at the beginning of the bytes, which are then those after it.
std::vector<char> decompressed(std::string_view& bytes, const Records& points, std::string_view name) {
  constexpr std::size_t kSizes = 2 * sizeof(std::uint32_t);
  constexpr std::uint64_t kMostExpansion = 88;  // of LZF: 3 bytes stand for 264 at most
  std::array<std::uint32_t, 2> sizes{};         // compressed, not compressed
  const auto fail = [&](const std::string& what) { throw InputError(fmt::format("{}: {}", name, what)); };
  if (bytes.size() < kSizes) fail(ends_early(0, points.count, "points"));
  std::memcpy(sizes.data(), bytes.data(), kSizes);
  bytes.remove_prefix(kSizes);
  const auto [compressed, whole] = sizes;
  if (compressed > bytes.size())
    fail(fmt::format("the file ends after {} of {} compressed bytes: it is cut short, copy it again",
                     bytes.size(), compressed));
  const std::int64_t size = bytes_per_point(points);
  if (whole / size != points.count || whole % size != 0)
    fail(fmt::format("{} points of {} bytes are announced, but {} compressed bytes hold {}", points.count,
                     size, compressed, whole));
  if (whole > compressed * kMostExpansion)
    fail(fmt::format("{} compressed bytes cannot hold {}: the file is damaged, copy it again", compressed,
                     whole));
  if (whole > kMaxItemBytes)
    fail(fmt::format("uncompressed {}; leave points out", too_many_bytes(whole, kMaxItemBytes)));
  std::vector<char> body(whole);
  if (lzf_decompress(bytes.data(), compressed, body.data(), whole) != whole)
    fail("the compressed bytes are damaged, copy the file again");
  bytes.remove_prefix(compressed);
  return body;
}

}  // namespace

PointCloud parse_pcd(std::string_view bytes, std::string_view name) {
  TextScanner in(bytes, name, '#', LineEnds::as_first);
  const PcdHeader header = read_pcd_header(in);
  const Records& points = header.schema.records[0];
  std::string_view body = in.text_after_line();
  std::vector<char> unpacked;
  if (header.schema.encoding == Encoding::columns) {
    unpacked = decompressed(body, points, name);
    require_end(body, points, in, header.schema);
    body = {unpacked.data(), unpacked.size()};
  }
  PointCloud cloud = read_cloud_records(in, body, header.schema, points,
                                        {"x", "y", "z", "normal_x", "normal_y", "normal_z"});
  cloud.viewpoint = known_viewpoint(header.viewpoint, static_cast<double>(header.height.value_or(1)));
  return cloud;
}

}  // namespace salbench
