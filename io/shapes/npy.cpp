// SPDX-License-Identifier: GPL-3.0-or-later
// Magic, version (2 bytes), length of the header (2 bytes; 4 from version 2 on), the header, the values. The
// header is a dictionary as Python writes it, and NumPy takes what Python would: quotes of both kinds, blanks
// or none, a "u" before strings and an "L" behind numbers, as Python 2 wrote them, keys in any order.
#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/shapes/records.h"
#include "io/shapes/values_file.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

constexpr std::string_view kNpy = "\x93NUMPY";

struct BadNpy {
  std::string why;
};
[[noreturn]] void refuse_npy(std::string why) { throw BadNpy{std::move(why)}; }

struct NpyHeader {
  std::optional<std::string> type;  // as the file has it
  std::optional<std::vector<std::size_t>> shape;
};

// Reads the dictionary from left to right.
class NpyHeaderParser {
 public:
  explicit NpyHeaderParser(std::string_view text) : rest_(text) {}

  NpyHeader parse() {
    expect('{');
    while (!take('}')) {
      read_entry(string());
      if (take(',')) continue;
      expect('}');
      break;
    }
    skip_blanks();
    if (!rest_.empty()) fail("nothing");
    return std::move(header_);
  }

 private:
  void read_entry(const std::string& key) {
    expect(':');
    if (key == "descr" && !header_.type)
      header_.type = type();
    else if (key == "shape" && !header_.shape)
      header_.shape = shape();
    else if (key == "fortran_order")  // one for n and for n x 1
      read_flag();
    else
      refuse_npy(fmt::format("its header has {}, or has it twice", in_quotes(key)));
  }

  void read_flag() {
    if (!take_word("True") && !take_word("False")) fail("True or False");
  }

  // The name of a type. Records are told by their fields, and are no numbers.
  std::string type() {
    skip_blanks();
    if (!rest_.starts_with('[') && !rest_.starts_with('(')) return string();
    const std::string_view fields = rest_.substr(0, rest_.find(']') + 1);
    refuse_npy(fmt::format("its type is {}, expected numbers", in_quotes(fields.empty() ? rest_ : fields)));
  }

  std::vector<std::size_t> shape() {
    std::vector<std::size_t> extents;
    expect('(');
    bool is_tuple = true;
    while (!take(')')) {
      extents.push_back(extent());
      is_tuple = take(',');
      if (is_tuple) continue;
      expect(')');
      break;
    }
    if (!is_tuple && extents.size() == 1) refuse_npy("its shape is a number, expected a tuple of them");
    return extents;
  }

  std::size_t extent() {
    skip_blanks();
    std::size_t number = 0;
    const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), number);
    if (error != std::errc()) fail("an extent of its shape");
    rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
    if (rest_.starts_with('L')) rest_.remove_prefix(1);
    return number;
  }

  std::string string() {
    skip_blanks();
    if (rest_.starts_with('u')) rest_.remove_prefix(1);
    const char quote = rest_.empty() ? '\0' : rest_[0];
    const std::size_t end = rest_.substr(std::min<std::size_t>(1, rest_.size())).find(quote);
    if ((quote != '\'' && quote != '"') || end == rest_.npos) fail("a text in quotes");
    const std::string text(rest_.substr(1, end));
    if (text.find('\\') != text.npos) fail("a text without escapes");
    rest_.remove_prefix(end + 2);
    return text;
  }

  bool take_word(std::string_view word) {
    skip_blanks();
    if (!rest_.starts_with(word)) return false;
    rest_.remove_prefix(word.size());
    return true;
  }
  bool take(char c) { return take_word({&c, 1}); }
  void expect(char c) {
    if (!take(c)) fail(fmt::format("'{}'", c));
  }
  void skip_blanks() { rest_.remove_prefix(std::min(rest_.find_first_not_of(" \t\r\n\f"), rest_.size())); }
  [[noreturn]] void fail(std::string_view expected) const {
    refuse_npy(fmt::format("its header has {} where {} is expected", in_quotes(rest_), expected));
  }

  std::string_view rest_;
  NpyHeader header_;
};

// "<f8", "f8" or "float64"; nothing for another type.
std::optional<NumberType> number_type(std::string_view name) {
  const bool has_order = name.find_first_of("<>=|") == 0;
  if (has_order) name.remove_prefix(1);
  for (const NumberName& type : kNumberNames)
    if (name == type.in_npy || (name == type.name && !has_order)) return type.type();
  return {};
}

template <class Number>
ScalarField numbers_in(std::string_view bytes, bool swapped) {
  constexpr std::int64_t kExact = std::int64_t{1} << 53U;  // beyond it doubles have gaps
  ScalarField values(bytes.size() / sizeof(Number));
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto number = number_at<Number>(bytes.data() + i * sizeof(Number), swapped);
    if constexpr (std::is_integral_v<Number> && sizeof number == 8)
      if (std::cmp_greater(number, kExact) || std::cmp_less(number, -kExact))
        refuse_npy(fmt::format("it holds {}: whole numbers beyond 2^53 cannot be used, scale them", number));
    values[i] = static_cast<double>(number);
  }
  return values;
}

ScalarField values_in_npy(std::string_view bytes) {
  const auto byte = [&](std::size_t i) {
    return static_cast<std::size_t>(static_cast<unsigned char>(bytes[i]));
  };
  if (bytes.size() < 12) refuse_npy("it is cut short");
  if (byte(6) < 1 || byte(6) > 3 || byte(7) != 0)
    refuse_npy(fmt::format("its version is {}.{}, expected 1.0 to 3.0", byte(6), byte(7)));
  const bool long_header = byte(6) >= 2;
  const std::size_t length = byte(8) | byte(9) << 8U | (long_header ? byte(10) << 16U | byte(11) << 24U : 0);
  const std::size_t begin = long_header ? 12 : 10;
  if (bytes.size() - begin < length) refuse_npy("it is cut short");
  const std::string_view body = bytes.substr(begin + length);
  const auto [type_name, shape] = NpyHeaderParser(bytes.substr(begin, length)).parse();
  if (!type_name) refuse_npy("its header names no type");
  const auto type = number_type(*type_name);
  if (!type)
    refuse_npy(fmt::format("its type is {}, expected float16, float32, float64, or whole numbers",
                           in_quotes(*type_name)));
  if (!shape) refuse_npy("its header names no shape");
  constexpr std::size_t kMostTold = 100;  // letters
  const std::string extents = fmt::format("({})", fmt::join(*shape, ", ")).substr(0, kMostTold);
  const auto is_not_1 = [](std::size_t extent) { return extent != 1; };
  if (shape->empty() || std::ranges::count_if(*shape, is_not_1) > 1)
    refuse_npy(fmt::format("its shape is {}, expected one value per point", extents));
  const auto longest = std::ranges::find_if(*shape, is_not_1);
  const std::size_t count = longest == shape->end() ? 1 : *longest;
  if (body.size() % type->bytes != 0 || body.size() / type->bytes != count)
    refuse_npy(fmt::format("its shape is {}, and it holds {} bytes of values", extents, body.size()));
  return with_type(*type,
                   [&](auto zero) { return numbers_in<decltype(zero)>(body, type_name->starts_with('>')); });
}

}  // namespace

bool is_npy(std::string_view bytes) { return bytes.starts_with(kNpy); }

ScalarField parse_npy(std::string_view bytes, std::string_view name) try {
  return values_in_npy(bytes);
} catch (const BadNpy& error) {
  throw InputError(fmt::format("{}: not a .npy file that can be read: {}", name, error.why));
}

}  // namespace salbench
