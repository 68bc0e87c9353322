// SPDX-License-Identifier: GPL-3.0-or-later
// Object File Format of Geomview, text form, with the liberties that files take: counts on the header's line
// or glued to it (ModelNet's "OFF490 518 0"), no header word, colours behind faces.

#include <algorithm>
#include <array>
#include <exception>

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
  if (in.peek_word().empty() && !in.next_filled_line())
    in.fail("the file ends before the counts: copy it again");
  const std::int64_t count = in.integer();
  if (const std::string wrong = wrong_with_count(count, plural); !wrong.empty()) in.fail(wrong);
  return count;
}

// The number of edges is often wrong; it may be missing, or stand alone on the next line.
void skip_number_of_edges(TextScanner& in) {
  TextScanner next = in;
  const bool on_next_line = next.peek_word().empty() && next.next_filled_line();
  if (!is_count(next.word()) || (on_next_line && !next.peek_word().empty())) return;
  in = next;
}

Counts read_counts(TextScanner& in) {
  if (!in.next_filled_line()) in.fail("the file has no text but comments: expected an OFF file");
  skip_header_word(in);
  const std::int64_t vertices = read_count(in, "vertices");
  const std::int64_t faces = read_count(in, "faces");
  skip_number_of_edges(in);
  return {vertices, faces};
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

// Columns behind the coordinates or corners: colours, normals, texture coordinates. No file announces them
// reliably, and only the line's end tells where they stop, so a record with some begins a line.
enum class FurtherColumns { skipped, none };

Mesh read_body(TextScanner in, const Counts& announced, FurtherColumns columns, PolygonCounts& counts) {
  const auto end_record = [&] {
    if (columns == FurtherColumns::skipped) in.skip_further_columns();
    in.end_record();
  };
  Mesh mesh;
  mesh.vertices.reserve(room_for(announced.vertices, in.text_after_line().size()));
  mesh.faces.reserve(room_for(announced.faces, in.text_after_line().size()));
  if (columns == FurtherColumns::skipped) in.skip_line();  // behind the counts

  in.begin_records(announced.vertices, "vertices");
  for (std::int64_t i = 0; i < announced.vertices; ++i) {
    in.next_record();
    mesh.vertices.push_back(read_point(in));
    end_record();
  }
  in.begin_records(announced.faces, "faces");
  Polygons polygons;
  std::vector<std::int32_t> polygon;
  for (std::int64_t i = 0; i < announced.faces; ++i) {
    in.next_record();
    read_face(in, announced.vertices, polygon);
    polygons.add(polygon, in.line_number(), mesh.faces);
    end_record();
  }
  in.end_records(
      fmt::format("there is more text after {} vertices and {} faces: the counts at the top are wrong",
                  announced.vertices, announced.faces));
  counts = polygons.split(mesh, [&](std::size_t line, const std::string& why) { in.fail_at(line, why); });
  return mesh;
}

}  // namespace

// Tries a record per line first; if that does not fit the counts, several records per line, without further
// columns.
Mesh parse_off(std::string_view text, std::string_view name, PolygonCounts* counts) {
  TextScanner in(text, name, '#');
  const Counts announced = read_counts(in);
  PolygonCounts found;
  if (counts == nullptr) counts = &found;
  try {
    return read_body(in, announced, FurtherColumns::skipped, *counts);
  } catch (const InputError&) {
    const std::exception_ptr by_lines = std::current_exception();
    try {
      return read_body(in, announced, FurtherColumns::none, *counts);
    } catch (const InputError&) {
      std::rethrow_exception(by_lines);
    }
  }
}

}  // namespace salbench
