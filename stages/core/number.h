// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>

namespace salbench {

// Number that the entire text represents, as parsed by std::from_chars; nullopt for any other text, and for a
// number beyond the type's range.
template <class Number, class... Base>
std::optional<Number> number_in(std::string_view text, Base... base) {
  Number number{};
  const char* end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, number, base...);
  return error == std::errc() && stopped == end ? std::optional(number) : std::nullopt;
}

}  // namespace salbench
