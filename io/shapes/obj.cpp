// SPDX-License-Identifier: GPL-3.0-or-later
// Wavefront OBJ: v and f records, in any order.

#include <charconv>

#include <fmt/format.h>

#include "io/shapes/mesh_file.h"
#include "io/shapes/mesh_parts.h"
#include "io/shapes/polygons.h"
#include "io/shapes/text_scanner.h"

namespace salbench {
namespace {

class ObjParser {
 public:
  ObjParser(std::string_view text, std::string_view name) : in_(text, name, '#') {}

  Mesh parse(PolygonCounts& counts) {
    while (in_.next_line()) {
      const std::string_view record = in_.peek_word();
      if (record != "v" && record != "f") continue;
      const bool is_vertex = record == "v";
      join_continued_lines();
      in_.skip_word();
      is_vertex ? read_vertex() : read_face();
    }
    check_forward_references();
    if (mesh_.vertices.empty()) in_.fail("the file ends without a vertex (v): expected an OBJ file");
    counts =
        polygons_.split(mesh_, [&](std::size_t line, const std::string& why) { in_.fail_at(line, why); });
    return std::move(mesh_);
  }

 private:
  struct ForwardReference {
    std::int64_t index;  // 1-based, as in the file
    std::size_t line_number;
  };

  // A backslash at the end of a line continues it. In other records it may be part of a material's or group's
  // name.
  void join_continued_lines() {
    if (!ends_in_backslash(in_.line())) return;
    joined_.clear();
    do {
      joined_ += in_.line().substr(0, in_.line().rfind('\\'));
      joined_ += ' ';
    } while (in_.next_line() && ends_in_backslash(in_.line()));
    joined_ += in_.line();
    in_.replace_line(joined_);
  }

  static bool ends_in_backslash(std::string_view line) {
    const std::size_t last = line.find_last_not_of(" \t\r");
    return last != std::string_view::npos && line[last] == '\\';
  }

  void read_vertex() {
    Vec3& point = mesh_.vertices.emplace_back();
    for (double& coordinate : point) coordinate = in_.number();  // a weight or a colour may follow
    if (const auto wrong = wrong_with_point(point); !wrong.empty()) in_.fail(wrong);
    if (n_vertices() > kMaxVertices) in_.fail(wrong_with_count(n_vertices(), "vertices"));
  }

  void read_face() {
    polygon_.clear();
    for (std::string_view corner = in_.word(); !corner.empty(); corner = in_.word())
      polygon_.push_back(vertex_of(corner));
    if (const std::string wrong = wrong_with_polygon(static_cast<double>(polygon_.size())); !wrong.empty())
      in_.fail(wrong);
    polygons_.add(polygon_, in_.line_number(), mesh_.faces);
  }

  // Parses "v", "v/vt", "v//vn" or "v/vt/vn": 1-based, or negative, counting back from the last vertex.
  std::int32_t vertex_of(std::string_view corner) {
    std::int64_t index = 0;
    const auto [end, error] = std::from_chars(corner.data(), corner.data() + corner.size(), index);
    const std::string_view rest = corner.substr(static_cast<std::size_t>(end - corner.data()));
    if (error != std::errc() || rest.find_first_not_of("/-0123456789") != std::string_view::npos ||
        !(rest.empty() || rest[0] == '/'))
      in_.fail(fmt::format("{} is not a corner of a face: v, v/vt, v//vn or v/vt/vn", in_quotes(corner)));
    if (index == 0 || index < -n_vertices() || index > kMaxVertices)
      fail_as_out_of_range(index, in_.line_number());
    if (index > n_vertices()) forward_references_.push_back({index, in_.line_number()});
    return static_cast<std::int32_t>(index < 0 ? index + n_vertices() : index - 1);
  }

  // Faces may precede their vertices, so that missing ones show only at the end of the file.
  void check_forward_references() const {
    for (const auto& [index, line_number] : forward_references_)
      if (index > n_vertices()) fail_as_out_of_range(index, line_number);
  }

  [[noreturn]] void fail_as_out_of_range(std::int64_t index, std::size_t line_number) const {
    in_.fail_at(line_number, index_out_of_range(static_cast<double>(index), 1, n_vertices()));
  }

  std::int64_t n_vertices() const { return std::ssize(mesh_.vertices); }

  TextScanner in_;
  Mesh mesh_;
  Polygons polygons_;
  std::vector<std::int32_t> polygon_;
  std::vector<ForwardReference> forward_references_;
  std::string joined_;
};

}  // namespace

Mesh parse_obj(std::string_view text, std::string_view name, PolygonCounts* counts) {
  PolygonCounts found;
  return ObjParser(text, name).parse(counts == nullptr ? found : *counts);
}

}  // namespace salbench
