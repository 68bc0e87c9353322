// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/shapes/text_scanner.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <type_traits>

#include <fmt/format.h>

namespace salbench {
namespace {

bool is_ascii_digit(char c) { return c >= '0' && c <= '9'; }

// Character that ends the first line: LF also for CR LF; '\0' if there is only one line.
char end_of_first_line(std::string_view text) {
  const std::size_t end = text.find_first_of("\r\n");
  if (end == std::string_view::npos) return '\0';
  return text[end] == '\r' && text.substr(end + 1, 1) != "\n" ? '\r' : '\n';
}

std::string_view without_comment(std::string_view line, char comment) {
  for (std::size_t at = line.find(comment); at != std::string_view::npos; at = line.find(comment, at + 1))
    if (at == 0 || is_space(line[at - 1])) return line.substr(0, at);
  return line;
}

// Removes a plus sign, which files contain but std::from_chars rejects.
std::string_view without_plus(std::string_view word) {
  const bool plus = word.size() > 1 && word[0] == '+' && word[1] != '-';
  return plus ? word.substr(1) : word;
}

// Hint for a word that is not a number: for "0,5", and for "1.#INF", "-1.#IND" or "1.#QNAN", which older C
// libraries of Windows print for infinity and NaN.
std::string_view hint_for(std::string_view word) {
  if (word.starts_with('+') || word.starts_with('-')) word.remove_prefix(1);
  if (word.starts_with("1.#")) return ": older Windows programs write infinity and NaN so";
  const std::size_t comma = word.find(',');
  if (comma == word.npos) return {};
  std::string_view after = word.substr(comma + 1);
  after = after.substr(0, after.find_first_of("eE"));
  const bool is_decimal = is_digits(word.substr(0, comma)) && !after.empty() && is_digits(after);
  return is_decimal ? ": write its decimal comma as a point" : "";
}

}  // namespace

TextScanner::TextScanner(std::string_view text, std::string_view name, char comment, LineEnds ends)
    : text_(without_byte_order_mark(text)), name_(name), size_(text.size()), comment_(comment) {
  if (ends == LineEnds::as_first) only_line_end_ = end_of_first_line(text_);
}

std::size_t TextScanner::line_length() const {
  if (only_line_end_ != '\0') return std::min(text_.find(only_line_end_), text_.size());
  const auto* const end = std::ranges::find_if(text_, [](char c) { return c == '\n' || c == '\r'; });
  return static_cast<std::size_t>(end - text_.begin());
}

bool TextScanner::next_line() {
  if (text_.empty()) {
    line_ = {};
    return false;
  }
  line_ = text_.substr(0, line_length());
  text_.remove_prefix(line_.size());
  const bool two = only_line_end_ == '\0' && text_.starts_with("\r\n");
  text_.remove_prefix(std::min<std::size_t>(two ? 2 : 1, text_.size()));
  if (comment_ != '\0') line_ = without_comment(line_, comment_);
  ++line_number_;
  return true;
}

bool TextScanner::next_filled_line() {
  while (next_line())
    if (!at_line_end()) return true;
  return false;
}

void TextScanner::skip_line() { line_ = {}; }

void TextScanner::end_header() {
  skip_line();
  only_line_end_ = '\0';
}

std::string_view TextScanner::peek_word() {
  if (at_line_end()) return {};
  std::size_t size = 1;
  while (size < line_.size() && !is_space(line_[size])) ++size;
  return line_.substr(0, size);
}

std::string_view TextScanner::word() {
  const std::string_view found = peek_word();
  line_.remove_prefix(found.size());
  return found;
}

std::string_view TextScanner::expected_word(std::string_view what) {
  const std::string_view found = word();
  if (found.empty()) fail(fmt::format("the line ends where {} is expected", what));
  return found;
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
                     std::is_floating_point_v<Number> ? hint_for(found) : ""));
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
  if (line_number_ == 0) throw InputError(fmt::format("{}: {}", name_, what));  // no line to name
  fail_at(line_number_, what);
}

void TextScanner::fail_at(std::size_t line_number, std::string_view what) const {
  throw InputError(fmt::format("{}:{}: {}", name_, line_number, what));
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

namespace {

// Length in bytes of the first character; 0 if it is not valid UTF-8.
std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(0);
  const std::size_t length = first < 0x80   ? 1
                             : first < 0xc2 ? 0
                             : first < 0xe0 ? 2
                             : first < 0xf0 ? 3
                             : first < 0xf5 ? 4
                                            : 0;
  if (length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xc0U) != 0x80) return 0;
  const unsigned second = length > 2 ? byte(1) : 0x80;
  const bool is_longer_than_needed = (first == 0xe0 && second < 0xa0) || (first == 0xf0 && second < 0x90);
  const bool is_no_character = (first == 0xed && second > 0x9f) || (first == 0xf4 && second > 0x8f);
  return is_longer_than_needed || is_no_character ? 0 : length;
}

}  // namespace

std::string_view wrong_with_line(std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    if (length == 0) return "a byte that is no UTF-8";
    const std::string_view character = text.substr(0, length);
    const bool is_of_latin_1 = length == 2 && character >= "\xc2\x80" && character <= "\xc2\x9f";
    if ((length == 1 && (text[0] < ' ' || text[0] == '\x7f')) || is_of_latin_1) return "a control character";
    if (character == "\xe2\x80\xa8") return "a line separator";
    if (character == "\xe2\x80\xa9") return "a paragraph separator";
    text.remove_prefix(length);
  }
  return {};
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
  return a < b;  // equal except for leading zeros
}

}  // namespace salbench
