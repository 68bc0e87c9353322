// SPDX-License-Identifier: GPL-3.0-or-later
// Walks over a text in memory by lines and words, and names the line where something is wrong.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "stages/core/errors.h"

namespace salbench {

// any: LF, CR LF and CR each end a line wherever they stand.
// as_first: the end of the first line decides, for a header before bytes that could pass for line ends.
enum class LineEnds { any, as_first };

inline bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

// Spaces and tabs separate words. A byte order mark at the start is skipped. The text must outlive the
// scanner.
class TextScanner {
 public:
  // Skips from a word that begins with `comment` to the end of the line; '\0' for a format without comments.
  TextScanner(std::string_view text, std::string_view name, char comment = '\0',
              LineEnds ends = LineEnds::any);

  bool next_line();         // false at the end of the text
  bool next_filled_line();  // the next line that has a word
  void skip_line();         // what is left of this one
  void end_header();        // from here on, lines end in any way; what is left of this one is skipped

  bool at_line_end() {  // no word is left
    std::size_t blanks = 0;
    while (blanks < line_.size() && is_space(line_[blanks])) ++blanks;
    line_.remove_prefix(blanks);
    return line_.empty();
  }
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
  std::size_t size() const { return size_; }  // of the whole text, in bytes

  [[noreturn]] void fail(std::string_view what) const;  // InputError "NAME:LINE: what"
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

bool is_digits(std::string_view word);  // 0 to 9, or nothing

// A strict total order that compares runs of digits as numbers: "2" < "10", "1_2" < "1_10".
bool natural_less(std::string_view a, std::string_view b);

std::string_view without_byte_order_mark(std::string_view text);

// "the file ends after 5 of 10 vertices: ..."
std::string ends_early(std::int64_t complete, std::int64_t announced, std::string_view plural);

// What makes a text no line of UTF-8, as tables and pages have them: "a control character". Empty if nothing
// does.
std::string_view wrong_with_line(std::string_view text);

// A word of an unknown file for a message: in quotes, short, printable.
std::string in_quotes(std::string_view word);

}  // namespace salbench
