// SPDX-License-Identifier: GPL-3.0-or-later
// The header says what the body consists of. Binary bodies hold a point after the other; compressed ones hold
// a field after the other, as one block of LZF. [rusu2011]

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <vector>

#include <fmt/format.h>
#include <lzf.h>

#include "io/file.h"
#include "io/shapes/cloud_file.h"
#include "io/shapes/mesh_parts.h"
#include "io/shapes/pcd_header.h"
#include "io/shapes/text_scanner.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

using pcd::Data;
using pcd::Field;
using pcd::Header;

static_assert(std::endian::native == std::endian::little, "numbers are read as they lie in the file");

// The numbers of a point that are read: x, y, z and, where the file has all three, a normal.
struct ChosenColumns {
  std::array<const Field*, 6> fields{};
  std::size_t count = 3;

  explicit ChosenColumns(const Header& header) {
    constexpr std::array names = {"x", "y", "z", "normal_x", "normal_y", "normal_z"};
    bool normals = true;
    for (std::size_t i = 0; i < names.size(); ++i) {
      fields[i] = header.find(names[i]);
      normals &= i < 3 || (fields[i] != nullptr && fields[i]->count == 1);
    }
    if (normals) count = fields.size();
  }
  std::size_t index_of(const Field& field) const {  // `count` for what is not read
    return static_cast<std::size_t>(
        std::find(fields.begin(), fields.begin() + static_cast<long>(count), &field) - fields.begin());
  }
};

void add_point(PointCloud& cloud, const std::array<double, 6>& values, std::size_t count) {
  cloud.points.emplace_back(values[0], values[1], values[2]);
  if (count > 3) cloud.normals.emplace_back(values[3], values[4], values[5]);
}

void read_ascii(TextScanner in, const Header& header, const ChosenColumns& wanted, PointCloud& cloud) {
  in.begin_records(header.points, "points");
  std::array<double, 6> values{};
  for (std::int64_t i = 0; i < header.points; ++i) {
    in.next_record();
    for (const Field& field : header.fields) {
      if (const std::size_t at = wanted.index_of(field); at < wanted.count)
        values[at] = in.number_or_nan();
      else
        for (std::int64_t k = 0; k < field.count; ++k) in.skip_word();
    }
    in.end_record();
    add_point(cloud, values, wanted.count);
  }
  in.end_records("there is more text after the last point: the header is wrong");
}

template <class T>
double number_at(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return static_cast<double>(value);
}

double number_at(const char* bytes, const Field& field) {
  switch (field.size) {
    case 1:
      return field.type == 'I' ? number_at<std::int8_t>(bytes) : number_at<std::uint8_t>(bytes);
    case 2:
      return field.type == 'I' ? number_at<std::int16_t>(bytes) : number_at<std::uint16_t>(bytes);
    case 4:
      if (field.type == 'F') return number_at<float>(bytes);
      return field.type == 'I' ? number_at<std::int32_t>(bytes) : number_at<std::uint32_t>(bytes);
    default:
      if (field.type == 'F') return number_at<double>(bytes);
      return field.type == 'I' ? number_at<std::int64_t>(bytes) : number_at<std::uint64_t>(bytes);
  }
}

// Location of a field in a body: its value for the first point, and the bytes from one point to the next.
struct Column {
  const char* first = nullptr;
  std::int64_t step = 0;
};

// `body` holds all points.
void read_columns(const char* body, const Header& header, const ChosenColumns& wanted, bool field_by_field,
                  PointCloud& cloud) {
  std::array<Column, 6> columns;
  std::int64_t offset = 0;
  for (const Field& field : header.fields) {
    if (const std::size_t at = wanted.index_of(field); at < wanted.count)
      columns[at] = {body + offset, field_by_field ? field.bytes() : header.bytes_per_point()};
    offset += field_by_field ? field.bytes() * header.points : field.bytes();
  }
  cloud.points.reserve(static_cast<std::size_t>(header.points));
  std::array<double, 6> values{};
  for (std::int64_t i = 0; i < header.points; ++i) {
    for (std::size_t at = 0; at < wanted.count; ++at)
      values[at] = number_at(columns[at].first + i * columns[at].step, *wanted.fields[at]);
    add_point(cloud, values, wanted.count);
  }
}

// The header's counts against bytes that are there, without a product that could overflow.
void require_points(std::string_view bytes, const Header& header, std::string_view name) {
  const std::int64_t complete = std::ssize(bytes) / header.bytes_per_point();
  if (complete < header.points)
    throw InputError(fmt::format("{}: {}", name, ends_early(complete, header.points, "points")));
}

// Zeros and line ends may fill the file up.
void require_end(std::string_view rest, std::string_view name) {
  if (rest.find_first_not_of(std::string_view("\0 \r\n", 4)) != std::string_view::npos)
    throw InputError(fmt::format(
        "{}: there are {} bytes after the last point: the header is wrong, or the file went through a "
        "conversion of line ends",
        name, rest.size()));
}

std::vector<char> decompressed(std::string_view& bytes, const Header& header, std::string_view name) {
  constexpr std::size_t kSizes = 2 * sizeof(std::uint32_t);
  constexpr std::uint64_t kMostExpansion = 88;  // of LZF: 3 bytes stand for 264 at most
  std::array<std::uint32_t, 2> sizes{};         // compressed, not compressed
  if (bytes.size() < kSizes)
    throw InputError(fmt::format("{}: {}", name, ends_early(0, header.points, "points")));
  std::memcpy(sizes.data(), bytes.data(), kSizes);
  bytes.remove_prefix(kSizes);
  const auto [compressed, whole] = sizes;
  if (compressed > bytes.size())
    throw InputError(
        fmt::format("{}: the file ends after {} of {} compressed bytes: it is cut short, copy it again", name,
                    bytes.size(), compressed));
  if (whole / header.bytes_per_point() != header.points || whole % header.bytes_per_point() != 0)
    throw InputError(fmt::format("{}: {} points of {} bytes are announced, but {} compressed bytes hold {}",
                                 name, header.points, header.bytes_per_point(), compressed, whole));
  if (whole > compressed * kMostExpansion)
    throw InputError(fmt::format("{}: {} compressed bytes cannot hold {}: the file is damaged, copy it again",
                                 name, compressed, whole));
  if (whole > kMaxItemBytes)
    throw InputError(
        fmt::format("{}: uncompressed {}; leave points out", name, too_many_bytes(whole, kMaxItemBytes)));
  std::vector<char> body(whole);
  if (lzf_decompress(bytes.data(), compressed, body.data(), whole) != whole)
    throw InputError(fmt::format("{}: the compressed bytes are damaged, copy the file again", name));
  bytes.remove_prefix(compressed);
  return body;
}

}  // namespace

PointCloud parse_pcd(std::string_view bytes, std::string_view name) {
  TextScanner in(bytes, name, '#', LineEnds::as_first);
  const Header header = pcd::read_header(in);
  if (header.points == 0) in.fail("the header announces no points");
  const ChosenColumns wanted(header);
  PointCloud cloud;
  const bool known = header.viewpoint && !header.viewpoint->isZero(0);
  if (known || header.height > 1) cloud.viewpoint = header.viewpoint.value_or(Vec3::Zero());
  std::string_view body = in.text_after_line();
  if (header.data == Data::ascii) {
    cloud.points.reserve(room_for(header.points, body.size()));
    read_ascii(in, header, wanted, cloud);
  } else if (header.data == Data::binary) {
    require_points(body, header, name);
    read_columns(body.data(), header, wanted, false, cloud);
    require_end(body.substr(static_cast<std::size_t>(header.points * header.bytes_per_point())), name);
  } else {
    const std::vector<char> whole = decompressed(body, header, name);
    read_columns(whole.data(), header, wanted, true, cloud);
    require_end(body, name);
  }
  return cloud;
}

}  // namespace salbench
