// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/shapes/pcd_header.h"

#include <algorithm>

#include <fmt/format.h>

#include "io/shapes/mesh_parts.h"

namespace salbench::pcd {
namespace {

constexpr std::int64_t kMaxCount = 100'000;  // values of one field: histograms have some hundreds
constexpr std::size_t kMaxFields = 10'000;

class HeaderParser {
 public:
  explicit HeaderParser(TextScanner& in) : in_(in) {}

  Header parse() {
    while (in_.next_filled_line()) {
      const std::string_view keyword = in_.word();
      if (keyword == "FIELDS" || keyword == "COLUMNS")
        read_names();
      else if (keyword == "SIZE")
        read_each([&](Field& field) { read_size(field); });
      else if (keyword == "TYPE")
        read_each([&](Field& field) { read_type(field); });
      else if (keyword == "COUNT")
        read_each([&](Field& field) { field.count = whole_number(0, kMaxCount); });
      else if (keyword == "WIDTH")
        width_ = whole_number(0, kMaxVertices);
      else if (keyword == "HEIGHT")
        height_ = whole_number(0, kMaxVertices);
      else if (keyword == "POINTS")
        points_ = whole_number(0, kMaxVertices);
      else if (keyword == "VIEWPOINT")
        read_viewpoint();
      else if (keyword == "DATA")
        return finished();
      else if (keyword != "VERSION")
        in_.fail(fmt::format("{} is not a keyword of a PCD header", in_quotes(keyword)));
    }
    in_.fail("the file ends within the header: it is cut short, or not a PCD file");
  }

 private:
  void read_names() {
    header_.fields.clear();
    for (std::string_view name = in_.word(); !name.empty(); name = in_.word())
      header_.fields.push_back({.name = std::string(name)});
    if (header_.fields.size() > kMaxFields)
      in_.fail(fmt::format("{} fields: at most {} can be read", header_.fields.size(), kMaxFields));
  }

  // One word per field.
  template <class Read>
  void read_each(const Read& read) {
    if (header_.fields.empty()) in_.fail("the line stands before FIELDS");
    for (Field& field : header_.fields) read(field);
    if (!in_.peek_word().empty())
      in_.fail(fmt::format("the line has more values than the {} fields", header_.fields.size()));
  }

  void read_size(Field& field) {
    field.size = whole_number(1, 8);
    if (field.size != 1 && field.size != 2 && field.size != 4 && field.size != 8)
      in_.fail(fmt::format("a value of {} bytes: 1, 2, 4 and 8 can be read", field.size));
  }

  void read_type(Field& field) {
    const std::string_view word = in_.word();
    if (word != "I" && word != "U" && word != "F")
      in_.fail(fmt::format("{} is not a PCD type: expected I, U or F", in_quotes(word)));
    field.type = word[0];
  }

  void read_viewpoint() {
    Vec3 position;
    for (Eigen::Index axis = 0; axis < 3; ++axis) position[axis] = in_.number();
    header_.viewpoint = position;  // its rotation turns nothing that is read here
  }

  std::int64_t whole_number(std::int64_t least, std::int64_t most) {
    const std::int64_t number = in_.integer();
    if (number < least || number > most)
      in_.fail(fmt::format("{} is not between {} and {}", number, least, most));
    return number;
  }

  Header finished() {
    header_.data = read_data();
    in_.end_header();
    header_.height = height_.value_or(1);
    const std::optional<std::int64_t> size =
        width_ ? std::optional(*width_ * header_.height) : std::nullopt;  // both below 2^31
    if (!size && !points_) in_.fail("the header has neither WIDTH nor POINTS");
    if (size && points_ && *size != *points_)
      in_.fail(fmt::format("the header announces {} points, and {} x {}", *points_, *width_, header_.height));
    header_.points = points_ ? *points_ : *size;
    if (const std::string wrong = wrong_with_count(header_.points, "points"); !wrong.empty()) in_.fail(wrong);
    for (const Field& field : header_.fields)
      if (field.type == 'F' && field.size < 4 && field.count > 0)
        in_.fail(fmt::format("field {}: floating point of {} bytes cannot be read", in_quotes(field.name),
                             field.size));
    for (const char* axis : {"x", "y", "z"})
      if (const Field* field = header_.find(axis); field == nullptr || field->count != 1)
        in_.fail(fmt::format("the header has no field \"{}\" of one number per point", axis));
    return std::move(header_);
  }

  Data read_data() {
    const std::string_view word = in_.word();
    if (word == "ascii") return Data::ascii;
    if (word == "binary") return Data::binary;
    if (word == "binary_compressed") return Data::binary_compressed;
    in_.fail(
        fmt::format("{} is not a PCD format: expected ascii, binary or binary_compressed", in_quotes(word)));
  }

  TextScanner& in_;
  Header header_;
  std::optional<std::int64_t> width_, height_, points_;
};

}  // namespace

const Field* Header::find(std::string_view field) const {
  const auto found =
      std::find_if(fields.begin(), fields.end(), [&](const Field& f) { return f.name == field; });
  return found == fields.end() ? nullptr : &*found;
}

std::int64_t Header::bytes_per_point() const {
  std::int64_t sum = 0;
  for (const Field& field : fields) sum += field.bytes();
  return sum;
}

Header read_header(TextScanner& in) { return HeaderParser(in).parse(); }

}  // namespace salbench::pcd
