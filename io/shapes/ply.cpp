// SPDX-License-Identifier: GPL-3.0-or-later
// Header of a PLY file, which describes the elements of its body. [turk1994]
#include <utility>

#include <fmt/format.h>

#include "io/shapes/cloud_file.h"
#include "io/shapes/mesh_file.h"
#include "io/shapes/mesh_parts.h"
#include "io/shapes/records.h"

namespace salbench {
namespace {

NumberType ply_type(TextScanner& in) {
  const std::string_view word = in.word();
  for (const NumberName& type : kNumberNames)
    if (word == type.name || word == type.sized) return type.type;
  in.fail(fmt::format("{} is not a PLY type: expected one such as uchar, int or float", in_quotes(word)));
}

Encoding ply_encoding(TextScanner& in) {
  const std::string_view word = in.word();
  if (word == "ascii") return Encoding::text;
  if (word == "binary_little_endian") return Encoding::little_endian;
  if (word == "binary_big_endian") return Encoding::big_endian;
  in.fail(fmt::format("{} is not a PLY format: expected ascii, binary_little_endian or binary_big_endian",
                      in_quotes(word)));
}

std::string name_in_line(TextScanner& in) {
  const std::string_view word = in.word();
  if (word.empty()) in.fail("the line ends where a name is expected");
  return std::string(word);
}

Records read_element(TextScanner& in) {
  Records element{.name = name_in_line(in)};
  element.count = in.integer();
  if (element.count < 0)
    in.fail(
        fmt::format("{} elements {}: a count cannot be negative", element.count, in_quotes(element.name)));
  return element;
}

Column read_property(TextScanner& in) {
  Column property;
  if (in.peek_word() == "list") {
    in.word();
    property.length = ply_type(in);
  }
  property.type = ply_type(in);
  property.name = name_in_line(in);
  return property;
}

// Reads up to and including "end_header".
Schema read_ply_header(TextScanner& in) {
  if (!in.next_line() || in.word() != "ply")
    in.fail("the file does not begin with \"ply\": expected a PLY file");
  Schema schema{.whole_numbers_have_points = true};
  bool has_format = false;
  while (in.next_line()) {
    const std::string_view keyword = in.word();
    if (keyword == "format") {
      schema.encoding = ply_encoding(in);
      has_format = true;
      in.skip_line();  // version
    } else if (keyword == "element") {
      schema.records.push_back(read_element(in));
    } else if (keyword == "property") {
      if (schema.records.empty()) in.fail("a property stands before the first element");
      schema.records.back().columns.push_back(read_property(in));
    } else if (keyword == "end_header") {
      if (!has_format) in.fail("the header names no format");
      in.end_header();
      return schema;
    } else if (keyword.empty() || keyword == "comment" || keyword == "obj_info") {
      in.skip_line();
    } else {
      in.fail(fmt::format("{} is not a keyword of a PLY header", in_quotes(keyword)));
    }
    if (!in.at_line_end())
      in.fail(fmt::format(
          "{} follows the last word of the line; all lines of a header have to end like the first",
          in_quotes(in.word())));
  }
  in.fail("the file ends within the header: it is cut short, copy it again");
}

// Bytes of a binary body may look like line ends.
TextScanner scanner_of(std::string_view bytes, std::string_view name) {
  return {bytes, name, '\0', LineEnds::as_first};
}

void check_count(const TextScanner& in, const Records& element) {
  if (const std::string wrong = wrong_with_count(element.count, element.plural()); !wrong.empty())
    in.fail(wrong);
}

void require_vertices(const Schema& header, const TextScanner& in, std::string_view held) {
  const Records* vertices = header.find("vertex");
  if (vertices == nullptr)
    in.fail(fmt::format("the header has no element \"vertex\": the file holds no {}", held));
  for (const char* axis : {"x", "y", "z"})
    if (vertices->number(axis) == nullptr)
      in.fail(fmt::format("the header gives vertices no number \"{}\"", axis));
  check_count(in, *vertices);
}

const Column& corners_of(const Records& faces, const TextScanner& in) {
  check_count(in, faces);
  for (const char* name : {"vertex_indices", "vertex_index"})
    if (const Column* corners = faces.list(name)) return *corners;
  in.fail("the header gives faces no list \"vertex_indices\"");
}

}  // namespace

Mesh parse_ply(std::string_view bytes, std::string_view name, PolygonCounts* counts) {
  TextScanner in = scanner_of(bytes, name);
  const Schema header = read_ply_header(in);
  require_vertices(header, in, "mesh");
  if (header.find("tristrips") != nullptr)
    in.fail("triangle strips cannot be read: write the mesh with an element \"face\"");
  const Records* faces = header.find("face");
  return read_mesh_records(in, header, faces == nullptr ? nullptr : &corners_of(*faces, in), counts);
}

PointCloud parse_ply_cloud(std::string_view bytes, std::string_view name) {
  TextScanner in = scanner_of(bytes, name);
  const Schema header = read_ply_header(in);
  require_vertices(header, in, "point cloud");
  if (const Records* faces = header.find("face"); faces != nullptr && faces->count > 0)
    in.fail("the header announces faces: the file holds a mesh, and a point cloud was expected");
  return read_cloud_records(in, header);
}

bool ply_announces_faces(std::string_view bytes) try {
  TextScanner in = scanner_of(bytes, "");
  const Schema header = read_ply_header(in);
  const Records* faces = header.find("face");
  return (faces != nullptr && faces->count > 0) || header.find("tristrips") != nullptr;
} catch (const InputError&) {
  return true;
}

}  // namespace salbench
