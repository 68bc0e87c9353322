// SPDX-License-Identifier: GPL-3.0-or-later
// Scans text in memory by lines and words, and reports errors with their line.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "stages/core/errors.h"

namespace salbench {

// any: LF, CR LF and CR each end a line anywhere.
// as_first: only the kind of the first line's end, for a header before binary data.
enum class LineEnds { any, as_first };

inline bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

// Spaces and tabs separate words. A leading byte order mark is skipped. The text must outlive the scanner.
class TextScanner {
 public:
  // A word that begins with `comment` starts a comment to the end of the line; '\0': no comments.
  TextScanner(std::string_view text, std::string_view name, char comment = '\0',
              LineEnds ends = LineEnds::any);

  bool next_line();         // false at the end of the text
  bool next_filled_line();  // the next line that has a word
  void skip_line();         // rest of this line
  void end_header();        // skips the rest of this line; from here on, lines may end in any way

  bool at_line_end() {  // true if no word is left
    std::size_t blanks = 0;
    while (blanks < line_.size() && is_space(line_[blanks])) ++blanks;
    line_.remove_prefix(blanks);
    return line_.empty();
  }
  std::string_view word();       // next word of the line; empty at its end
  std::string_view peek_word();  // the same, without advancing
  void skip_word();              // fails if there is none, as the following do:
  double number();               // finite
  double number_or_nan();        // also infinities and NaN, written where nothing was measured
  std::int64_t integer();

  std::string_view line() const { return line_; }  // rest of the line
  std::string_view text_after_line() const { return text_; }
  void replace_line(std::string_view line) { line_ = line; }  // continues in a line joined by the caller
  std::size_t line_number() const { return line_number_; }    // 1-based
  const std::string& name() const { return name_; }
  std::size_t size() const { return size_; }  // size of the whole text, in bytes

  [[noreturn]] void fail(std::string_view what) const;  // throws InputError "NAME:LINE: what"
  [[noreturn]] void fail_at(std::size_t line_number, std::string_view what) const;

 private:
  std::size_t line_length() const;
  std::string_view expected_word(std::string_view what);
  template <class Number>
  Number parsed(std::string_view what, std::string_view type);

  std::string_view text_;  // after the line
  std::string_view line_;
  std::string name_;
  std::size_t line_number_ = 0;
  std::size_t size_;
  char comment_;
  char only_line_end_ = '\0';  // '\0': any
};

bool is_digits(std::string_view word);  // only 0 to 9; may be empty

// Strict total order that compares runs of digits as numbers: "2" < "10", "1_2" < "1_10".
bool natural_less(std::string_view a, std::string_view b);

std::string_view without_byte_order_mark(std::string_view text);

// "the file ends after 5 of 10 vertices: ..."
std::string ends_early(std::int64_t complete, std::int64_t announced, std::string_view plural);

// Reason why a text is not a printable line of UTF-8, as tables and pages need: "a control character"; empty
// if it is one.
std::string_view wrong_with_line(std::string_view text);

// Word of an unknown file for a message: in quotes, short, printable.
std::string in_quotes(std::string_view word);

}  // namespace salbench
