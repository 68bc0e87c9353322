// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/shapes/ground_truth_file.h"

#include <charconv>

#include <fmt/format.h>

#include "io/shapes/text_scanner.h"

namespace salbench {
namespace {

bool is_name(std::string_view word) {
  const std::string_view digits = without_plus(word);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const bool is_number = error != std::errc::invalid_argument && end == digits.data() + digits.size();
  const bool begins_as_number = word.find_first_not_of("+-.0123456789") != 0;
  const bool is_infinity =
      begins_as_number && word.find('#') != word.npos;  // 1.#INF, as older programs wrote
  return !is_number && !is_infinity && decimal_comma_in(word).empty();
}

}  // namespace

ScalarField parse_values(std::string_view text, std::string_view name, const Elements& elements) {
  TextScanner in(text, name);
  ScalarField values;
  for (bool first = true; in.next_filled_line();) {
    if (in.peek_word().starts_with('#')) continue;
    const bool is_header = first && is_name(in.peek_word());
    first = false;
    is_header ? in.skip_word() : values.push_back(in.number());
    if (!in.peek_word().empty())
      in.fail(
          "the line has more than one column, expected one value: keep that column alone, in the order of "
          "the points; or, of ground truth, name it in a description of the data set (values: {column: "
          "...})");
  }
  if (elements.n != Elements::kUnknown && values.size() != elements.n)
    in.fail(fmt::format("the file has {} values, but the {} has {} {}{}", values.size(), elements.shape,
                        elements.n, elements.plural, elements.others ? elements.others(values.size()) : ""));
  if (values.empty()) in.fail("the file has no values");
  return values;
}

std::vector<std::int32_t> parse_picks(std::string_view text, std::string_view name,
                                      const Elements& elements) {
  TextScanner in(text, name, '#');
  std::vector<std::int32_t> picks;
  while (in.next_filled_line()) {
    const std::int64_t index = in.integer();
    if (index < 0 || index >= static_cast<std::int64_t>(elements.n))
      in.fail(fmt::format("{} {} is out of range: the {} has {} {}, numbered from 0", elements.one, index,
                          elements.shape, elements.n, elements.plural));
    picks.push_back(static_cast<std::int32_t>(index));
    if (!in.peek_word().empty()) in.fail("the line has more than one value");
  }
  return picks;
}

}  // namespace salbench
