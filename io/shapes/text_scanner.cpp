// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/shapes/text_scanner.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <type_traits>

#include <fmt/format.h>

namespace salbench {
namespace {

bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

bool is_ascii_digit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

TextScanner::TextScanner(std::string_view text, std::string_view name, char comment)
    : text_(without_byte_order_mark(text)),
      name_(name),
      comment_(comment),
      line_end_(text.find('\n') == std::string_view::npos ? '\r' : '\n') {}

bool TextScanner::next_line() {
  if (text_.empty()) {
    line_ = {};
    return false;
  }
  const std::size_t end = text_.find(line_end_);
  line_ = text_.substr(0, end);
  text_.remove_prefix(end == text_.npos ? text_.size() : end + 1);
  if (comment_ != '\0') line_ = line_.substr(0, line_.find(comment_));
  ++line_number_;
  return true;
}

bool TextScanner::next_filled_line() {
  while (next_line())
    if (!peek_word().empty()) return true;
  return false;
}

void TextScanner::begin_records(std::int64_t announced, std::string_view plural) {
  records_announced_ = announced;
  records_begun_ = 0;
  records_ = plural;
}

void TextScanner::next_record() {
  if (!next_filled_line()) fail(ends_early(records_begun_, records_announced_, records_));
  ++records_begun_;
}

std::string_view TextScanner::word() {
  std::size_t begin = 0;
  while (begin < line_.size() && is_space(line_[begin])) ++begin;
  std::size_t end = begin;
  while (end < line_.size() && !is_space(line_[end])) ++end;
  const std::string_view found = line_.substr(begin, end - begin);
  line_.remove_prefix(end);
  return found;
}

std::string_view TextScanner::peek_word() {
  const std::string_view here = line_;
  const std::string_view found = word();
  line_ = here;
  return found;
}

std::string_view TextScanner::expected_word(std::string_view what) {
  const std::string_view found = word();
  if (!found.empty()) return found;
  if (text_.empty() && !records_.empty()) fail(ends_early(records_begun_ - 1, records_announced_, records_));
  fail(fmt::format("the line ends where {} is expected", what));
}

void TextScanner::skip_word() { expected_word("a value"); }

template <class Number>
Number TextScanner::parsed(std::string_view what, std::string_view type) {
  const std::string_view found = expected_word(what);
  const std::string_view digits = without_plus(found);
  Number value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::result_out_of_range)
    fail(fmt::format("{} does not fit {}", in_quotes(found), type));
  if (error != std::errc() || end != digits.data() + digits.size())
    fail(fmt::format("{} is not {}{}", in_quotes(found), what,
                     std::is_floating_point_v<Number> ? decimal_comma_in(found) : ""));
  return value;
}

double TextScanner::number() {
  const std::string_view here = line_;
  const double value = number_or_nan();
  if (std::isfinite(value)) return value;
  line_ = here;
  fail(fmt::format("{} is not a finite number", in_quotes(word())));
}
double TextScanner::number_or_nan() { return parsed<double>("a number", "a double"); }
std::int64_t TextScanner::integer() { return parsed<std::int64_t>("a whole number", "64 bits"); }

void TextScanner::fail(std::string_view what) const {
  if (line_number_ == 0) throw InputError(fmt::format("{}: {}", name_, what));  // nothing there to point at
  fail_at(line_number_, what);
}

void TextScanner::fail_at(std::size_t line_number, std::string_view what) const {
  throw InputError(fmt::format("{}:{}: {}", name_, line_number, what));
}

std::string_view without_plus(std::string_view word) {
  const bool plus = word.size() > 1 && word[0] == '+' && word[1] != '-';
  return plus ? word.substr(1) : word;
}

std::string_view decimal_comma_in(std::string_view word) {
  const std::size_t comma = word.find(',');
  if (comma == std::string_view::npos || comma + 1 == word.size()) return {};
  std::string_view before = word.substr(0, comma), after = word.substr(comma + 1);
  if (!before.empty() && (before[0] == '+' || before[0] == '-')) before.remove_prefix(1);
  after = after.substr(0, after.find_first_of("eE"));
  return is_digits(before) && !after.empty() && is_digits(after) ? ": write its decimal comma as a point"
                                                                 : "";
}

bool is_digits(std::string_view word) {
  return word.find_first_not_of("0123456789") == std::string_view::npos;
}

std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  return text.starts_with(kByteOrderMark) ? text.substr(kByteOrderMark.size()) : text;
}

std::string ends_early(std::int64_t complete, std::int64_t announced, std::string_view plural) {
  return fmt::format("the file ends after {} of {} {}: it is cut short, copy it again", complete, announced,
                     plural);
}

std::string in_quotes(std::string_view word) {
  constexpr std::size_t kMaxLength = 32;
  std::string text = "\"";
  for (const char c : word.substr(0, kMaxLength)) text += c >= ' ' && c <= '~' ? c : '?';
  return text + (word.size() > kMaxLength ? "...\"" : "\"");
}

bool natural_less(std::string_view a, std::string_view b) {
  const auto digits_at = [](std::string_view text, std::size_t at) {
    const auto begin = text.begin() + static_cast<std::ptrdiff_t>(at);
    return std::string_view(begin, std::find_if_not(begin, text.end(), is_ascii_digit));
  };
  const auto significant = [](std::string_view digits) {
    digits.remove_prefix(std::min(digits.find_first_not_of('0'), digits.size()));
    return digits;
  };
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (is_ascii_digit(a[i]) && is_ascii_digit(b[j])) {
      const std::string_view run_a = digits_at(a, i), run_b = digits_at(b, j);
      const std::string_view x = significant(run_a), y = significant(run_b);
      if (x != y) return x.size() != y.size() ? x.size() < y.size() : x < y;
      i += run_a.size();
      j += run_b.size();
    } else {
      if (a[i] != b[j]) return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]);
      ++i;
      ++j;
    }
  }
  if (i < a.size() || j < b.size()) return j < b.size();
  return a < b;  // equal but for leading zeros
}

}  // namespace salbench
