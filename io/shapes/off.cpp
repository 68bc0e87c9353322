// SPDX-License-Identifier: GPL-3.0-or-later
// Object File Format of Geomview, text form, with the liberties that files take: counts on the header's line
// or glued to it (ModelNet's "OFF490 518 0"), no header word, colours behind faces. Line by line, since only
// the line's end tells where optional columns stop.

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "io/shapes/mesh_file.h"
#include "io/shapes/mesh_parts.h"
#include "io/shapes/polygons.h"
#include "io/shapes/text_scanner.h"

namespace salbench {
namespace {

struct Counts {
  std::int64_t vertices;
  std::int64_t faces;
};

bool is_count(std::string_view word) {
  return !word.empty() && word.find_first_not_of("+-0123456789") == std::string_view::npos;
}

// Skips the header word, if there is one.
void skip_header_word(TextScanner& in) {
  const std::string_view word = in.peek_word();
  if (is_count(word)) return;
  // Extra columns follow the coordinates, so these prefixes need no more than to be known. 4OFF and
  // nOFF have other dimensions.
  constexpr std::array<std::string_view, 8> kPrefixes = {"", "C", "N", "CN", "ST", "STC", "STN", "STCN"};
  const std::size_t at = std::min(word.find("OFF"), word.find("off"));
  if (at == std::string_view::npos)
    in.fail(
        fmt::format("{} is not an OFF header: the file is damaged, or has another format", in_quotes(word)));
  const std::string_view glued = word.substr(at + 3);
  if (std::find(kPrefixes.begin(), kPrefixes.end(), word.substr(0, at)) == kPrefixes.end() ||
      !(glued.empty() || is_count(glued)))
    in.fail(fmt::format("{} is an unknown kind of OFF: convert it to plain OFF", in_quotes(word)));
  std::string_view line = in.line();
  line.remove_prefix(static_cast<std::size_t>(glued.data() - line.data()));
  in.replace_line(line);
  if (in.peek_word() == "BINARY") in.fail("binary OFF cannot be read: convert it to text OFF or to PLY");
}

std::int64_t read_count(TextScanner& in, std::string_view plural) {
  const std::int64_t count = in.integer();
  if (const std::string wrong = wrong_with_count(count, plural); !wrong.empty()) in.fail(wrong);
  return count;
}

Counts read_counts(TextScanner& in) {
  if (!in.next_filled_line()) in.fail("the file has no text but comments: expected an OFF file");
  skip_header_word(in);
  if (in.peek_word().empty() && !in.next_filled_line())
    in.fail("the file ends before the counts: copy it again");
  const std::int64_t vertices = read_count(in, "vertices");
  const std::int64_t faces = read_count(in, "faces");
  return {vertices, faces};  // a number of edges may follow, which nobody keeps right
}

// "3 0 1 2", a colour behind it or not.
void read_face(TextScanner& in, std::int64_t n_vertices, std::vector<std::int32_t>& polygon) {
  const std::int64_t size = in.integer();
  if (const std::string wrong = wrong_with_polygon(size); !wrong.empty()) in.fail(wrong);
  polygon.clear();
  for (std::int64_t i = 0; i < size; ++i) {
    const std::int64_t index = in.integer();
    if (index < 0 || index >= n_vertices) in.fail(index_out_of_range(index, 0, n_vertices));
    polygon.push_back(static_cast<std::int32_t>(index));
  }
}

}  // namespace

Mesh parse_off(std::string_view text, std::string_view name, PolygonCounts* counts) {
  TextScanner in(text, name, '#');
  const Counts announced = read_counts(in);
  Mesh mesh;
  mesh.vertices.reserve(room_for(announced.vertices, text.size()));
  mesh.faces.reserve(room_for(announced.faces, text.size()));

  in.begin_records(announced.vertices, "vertices");
  for (std::int64_t i = 0; i < announced.vertices; ++i) {
    in.next_record();
    mesh.vertices.push_back(read_point(in));
  }
  in.begin_records(announced.faces, "faces");
  Polygons polygons;
  std::vector<std::int32_t> polygon;
  for (std::int64_t i = 0; i < announced.faces; ++i) {
    in.next_record();
    read_face(in, announced.vertices, polygon);
    polygons.add(polygon, in.line_number(), mesh.faces);
  }
  if (in.next_filled_line())
    in.fail(fmt::format("there is more text after {} vertices and {} faces: the counts at the top are wrong",
                        announced.vertices, announced.faces));
  const PolygonCounts found =
      polygons.split(mesh, [&](std::size_t line, const std::string& why) { in.fail_at(line, why); });
  if (counts != nullptr) *counts = found;
  return mesh;
}

}  // namespace salbench
