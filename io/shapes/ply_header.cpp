// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/shapes/ply_header.h"

#include <fmt/format.h>

namespace salbench::ply {
namespace {

template <class Named>
const Named* find_named(const std::vector<Named>& all, std::string_view name) {
  for (const Named& one : all)
    if (one.name == name) return &one;
  return nullptr;
}

struct TypeName {
  std::string_view name, synonym;  // both spellings are in use
  Type type;
};
constexpr TypeName kTypes[] = {
    {"char", "int8", std::int8_t{}},    {"uchar", "uint8", std::uint8_t{}},
    {"short", "int16", std::int16_t{}}, {"ushort", "uint16", std::uint16_t{}},
    {"int", "int32", std::int32_t{}},   {"uint", "uint32", std::uint32_t{}},
    {"float", "float32", float{}},      {"double", "float64", double{}},
};

Type read_type(TextScanner& in) {
  const std::string_view word = in.word();
  for (const auto& [name, synonym, type] : kTypes)
    if (word == name || word == synonym) return type;
  in.fail(fmt::format("{} is not a PLY type: expected one such as uchar, int or float", in_quotes(word)));
}

Encoding read_encoding(TextScanner& in) {
  const std::string_view word = in.word();
  if (word == "ascii") return Encoding::ascii;
  if (word == "binary_little_endian") return Encoding::little_endian;
  if (word == "binary_big_endian") return Encoding::big_endian;
  in.fail(fmt::format("{} is not a PLY format: expected ascii, binary_little_endian or binary_big_endian",
                      in_quotes(word)));
}

// A word too many may be the next line of a header whose lines end in different ways.
void require_line_end(TextScanner& in) {
  const std::string_view word = in.peek_word();
  if (!word.empty())
    in.fail(fmt::format("{} is a word too many; the lines of a header have to end as its first one does",
                        in_quotes(word)));
}

std::string read_name(TextScanner& in) {
  const std::string_view word = in.word();
  if (word.empty()) in.fail("the line ends where a name is expected");
  return std::string(word);
}

Element read_element(TextScanner& in) {
  Element element;
  element.name = read_name(in);
  element.count = in.integer();
  if (element.count < 0)
    in.fail(
        fmt::format("{} elements {}: a count cannot be negative", element.count, in_quotes(element.name)));
  require_line_end(in);
  return element;
}

Property read_property(TextScanner& in) {
  Property property;
  if (in.peek_word() == "list") {
    in.word();
    property.length_type = read_type(in);
  }
  property.type = read_type(in);
  property.name = read_name(in);
  require_line_end(in);
  return property;
}

}  // namespace

const Property* Element::find(std::string_view property) const { return find_named(properties, property); }

const Element* Header::find(std::string_view element) const { return find_named(elements, element); }

Header read_header(TextScanner& in) {
  if (!in.next_line() || in.word() != "ply")
    in.fail("the file does not begin with \"ply\": expected a PLY file");
  std::optional<Encoding> encoding;
  std::vector<Element> elements;
  while (in.next_line()) {
    const std::string_view keyword = in.word();
    if (keyword == "format") {
      encoding = read_encoding(in);
    } else if (keyword == "element") {
      elements.push_back(read_element(in));
    } else if (keyword == "property") {
      if (elements.empty()) in.fail("a property stands before the first element");
      elements.back().properties.push_back(read_property(in));
    } else if (keyword == "end_header") {
      if (!encoding) in.fail("the header names no format");
      in.end_header();
      return {*encoding, std::move(elements)};
    } else if (!keyword.empty() && keyword != "comment" && keyword != "obj_info") {
      in.fail(fmt::format("{} is not a keyword of a PLY header", in_quotes(keyword)));
    }
  }
  in.fail("the file ends within the header: it is cut short, copy it again");
}

}  // namespace salbench::ply
