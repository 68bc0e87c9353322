// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/shapes/values_file.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include "io/shapes/text_scanner.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

// True for a possible column name; false for a number, even a malformed one such as "12#3" or "0,5".
bool is_name(std::string_view word) {
  constexpr std::string_view kInNumbers = "+-.,#0123456789";
  double value = 0;  // unused; "nan" and "inf" also parse as numbers
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  const bool is_number = error == std::errc() && end == word.data() + word.size();
  return !is_number && kInNumbers.find(word[0]) == std::string_view::npos;
}

// Names a file that is no text of numbers; empty if its first bytes are those of none of these.
std::string_view kind_of_other_file(std::string_view bytes) {
  constexpr std::array<std::array<std::string_view, 2>, 6> kKinds = {
      {{"\x93NUMPY", "a .npy file of NumPy"},
       {"PK\x03\x04", "a zip archive, as .npz and .xlsx are"},
       {"\x89HDF\r\n", "an HDF5 file"},
       {"MATLAB 5.0", "a .mat file of MATLAB"},
       {"ply\n", "a PLY file"},
       {"ply\r", "a PLY file"}}};
  for (const auto& [start, kind] : kKinds)
    if (bytes.starts_with(start)) return kind;
  return {};
}

void require_text(std::string_view bytes, std::string_view name) {
  if (const std::string_view kind = kind_of_other_file(bytes); !kind.empty())
    throw InputError(fmt::format("{}: is {}, expected text: one value per line", name, kind));
}

}  // namespace

ScalarField parse_values(std::string_view text, std::string_view name, const Elements& elements) {
  require_text(text, name);
  TextScanner in(text, name, '#');
  ScalarField values;
  for (bool first = true; in.next_filled_line();) {
    const bool is_header = first && is_name(in.peek_word());
    first = false;
    is_header ? in.skip_word() : values.push_back(in.number());
    if (!in.at_line_end())
      in.fail(
          "the line has more than one column, expected one value: keep that column alone, in the order of "
          "the points");
  }
  if (elements.n != Elements::kUnknown && values.size() != elements.n)
    in.fail(fmt::format("the file has {} values, but the {} has {} {}{}", values.size(), elements.shape,
                        elements.n, elements.plural, elements.others ? elements.others(values.size()) : ""));
  if (values.empty()) in.fail("the file has no values");
  return values;
}

std::vector<std::int32_t> parse_picks(std::string_view text, std::string_view name,
                                      const Elements& elements) {
  require_text(text, name);
  TextScanner in(text, name, '#');
  std::vector<std::int32_t> picks;
  for (bool first = true; in.next_filled_line(); first = false) {
    const std::string_view word = in.peek_word();
    if (first && is_name(word)) {
      in.skip_word();
    } else {
      const double index = in.number();  // also whole ones such as 3.000e+00, as numpy.savetxt writes
      if (index != std::floor(index)) in.fail(fmt::format("{} is not a whole number", in_quotes(word)));
      if (!(index >= 0 && index < static_cast<double>(elements.n)))
        in.fail(fmt::format("{} {} is out of range: the {} has {} {}, numbered from 0", elements.one, index,
                            elements.shape, elements.n, elements.plural));
      picks.push_back(static_cast<std::int32_t>(index));
    }
    if (!in.at_line_end()) in.fail("the line has more than one value");
  }
  return picks;
}

void require_value_per_element(std::string_view name, std::size_t n_values, std::size_t n_points,
                               std::size_t n_faces) {
  if (n_values != n_points && (n_faces == 0 || n_values != n_faces))
    throw InputError(fmt::format("{}: {} values, but the shape has {} points{}", name, n_values, n_points,
                                 n_faces == 0 ? "" : fmt::format(" and {} faces", n_faces)));
}

}  // namespace salbench
