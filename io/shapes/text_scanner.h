// SPDX-License-Identifier: GPL-3.0-or-later
// Walks over a text in memory by lines and words, and names the line where something is wrong.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "stages/core/errors.h"

namespace salbench {

// Lines end in LF, CR LF, or (if the text has no LF at all) CR; spaces and tabs separate words. A byte order
// mark at the start is skipped. The text must outlive the scanner.
class TextScanner {
 public:
  // Skips from `comment` to the end of the line; '\0' for a format without comments.
  TextScanner(std::string_view text, std::string_view name, char comment = '\0');

  bool next_line();         // false at the end of the text
  bool next_filled_line();  // the next line that has a word

  // For formats that announce how many records follow, one to a line: from here on, a text that ends too
  // early is reported as "ends after 5 of 10 vertices".
  void begin_records(std::int64_t announced, std::string_view plural);
  void next_record();  // the next line that has a word; fails if there is none

  std::string_view word();       // the next word of the line; empty at its end
  std::string_view peek_word();  // the same, staying before it
  void skip_word();              // fails if there is none, as these do:
  double number();               // finite
  double number_or_nan();        // or an infinity: written where nothing was measured
  std::int64_t integer();

  std::string_view line() const { return line_; }  // what is left of the line
  std::string_view text_after_line() const { return text_; }
  void replace_line(std::string_view line) { line_ = line; }  // continues in a line that the caller joined
  std::size_t line_number() const { return line_number_; }    // 1-based
  const std::string& name() const { return name_; }

  [[noreturn]] void fail(std::string_view what) const;  // InputError "NAME:LINE: what"
  [[noreturn]] void fail_at(std::size_t line_number, std::string_view what) const;

 private:
  std::string_view expected_word(std::string_view what);
  template <class Number>
  Number parsed(std::string_view what, std::string_view type);

  std::string_view text_;  // after the line
  std::string_view line_;
  std::string name_;
  std::size_t line_number_ = 0;
  std::int64_t records_announced_ = 0;
  std::int64_t records_begun_ = 0;
  std::string records_;  // "vertices"; empty outside records
  char comment_;
  char line_end_;
};

// A number as std::from_chars takes it: without the plus sign that files do contain.
std::string_view without_plus(std::string_view word);

// ": write its decimal comma as a point" of a number such as "0,5"; empty for another word.
std::string_view decimal_comma_in(std::string_view word);

bool is_digits(std::string_view word);  // 0 to 9, or nothing

// A strict total order that compares runs of digits as numbers: "2" < "10", "1_2" < "1_10".
bool natural_less(std::string_view a, std::string_view b);

std::string_view without_byte_order_mark(std::string_view text);

// "the file ends after 5 of 10 vertices: ..."
std::string ends_early(std::int64_t complete, std::int64_t announced, std::string_view plural);

// A word of an unknown file for a message: in quotes, short, printable.
std::string in_quotes(std::string_view word);

}  // namespace salbench
