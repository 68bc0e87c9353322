// SPDX-License-Identifier: GPL-3.0-or-later
// Object File Format of Geomview, text form, with common deviations: counts on the header's line or joined to
// it (ModelNet's "OFF490 518 0"), no header word, colours after faces.
#include <algorithm>
#include <array>
#include <exception>

#include <fmt/format.h>

#include "io/shapes/mesh_file.h"
#include "io/shapes/mesh_parts.h"
#include "io/shapes/records.h"

namespace salbench {
namespace {

bool is_count(std::string_view word) {
  return !word.empty() && word.find_first_not_of("+-0123456789") == std::string_view::npos;
}

// Skips the header word if present.
void skip_header_word(TextScanner& in) {
  const std::string_view word = in.peek_word();
  if (is_count(word)) return;
  // Extra columns follow the coordinates and are skipped, so these prefixes only need to be known. 4OFF and
  // nOFF have other dimensions.
  constexpr std::array<std::string_view, 8> kPrefixes = {"", "C", "N", "CN", "ST", "STC", "STN", "STCN"};
  const std::size_t at = std::min(word.find("OFF"), word.find("off"));
  if (at == std::string_view::npos)
    in.fail(
        fmt::format("{} is not an OFF header: the file is damaged, or has another format", in_quotes(word)));
  const std::string_view glued = word.substr(at + 3);
  if (std::ranges::find(kPrefixes, word.substr(0, at)) == kPrefixes.end() ||
      !(glued.empty() || is_count(glued)))
    in.fail(fmt::format("{} is an unknown kind of OFF: convert it to plain OFF", in_quotes(word)));
  std::string_view line = in.line();
  line.remove_prefix(static_cast<std::size_t>(glued.data() - line.data()));
  in.replace_line(line);
  if (in.peek_word() == "BINARY") in.fail("binary OFF cannot be read: convert it to text OFF or to PLY");
}

std::int64_t read_count(TextScanner& in, std::string_view plural) {
  if (in.at_line_end() && !in.next_filled_line()) in.fail("the file ends before the counts: copy it again");
  const std::int64_t count = in.integer();
  if (const std::string wrong = wrong_with_count(count, plural); !wrong.empty()) in.fail(wrong);
  return count;
}

// The number of edges is often wrong, and may be missing or alone on the next line.
void skip_number_of_edges(TextScanner& in) {
  TextScanner next = in;
  const bool on_next_line = next.at_line_end() && next.next_filled_line();
  if (!is_count(next.word()) || (on_next_line && !next.at_line_end())) return;
  in = next;
}

// A face is "3 0 1 2", and may be followed by a colour.
Schema read_off_header(TextScanner& in) {
  if (!in.next_filled_line()) in.fail("the file has no text but comments: expected an OFF file");
  skip_header_word(in);
  Schema header;
  header.records.push_back({"vertex", read_count(in, "vertices"), {{"x"}, {"y"}, {"z"}}});
  header.records.push_back({"face", read_count(in, "faces"), {{.name = "corners", .length = NumberType{}}}});
  skip_number_of_edges(in);
  return header;
}

}  // namespace

// Tries one record per line first; if the counts do not match, several records per line, without further
// columns.
Mesh parse_off(std::string_view text, std::string_view name, PolygonCounts* counts) {
  TextScanner in(text, name, '#');
  Schema header = read_off_header(in);
  const auto read = [&](bool further_columns) {
    header.further_columns = further_columns;
    return read_mesh_records(in, header, header.records[1].list("corners"), counts);
  };
  try {
    return read(true);
  } catch (const InputError&) {
    const std::exception_ptr by_lines = std::current_exception();
    try {
      return read(false);
    } catch (const InputError&) {
      std::rethrow_exception(by_lines);
    }
  }
}

}  // namespace salbench
