// SPDX-License-Identifier: GPL-3.0-or-later
// Requirements on every message to the user.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "stages/core/check.h"

namespace salbench {

// Throws std::logic_error unless the text is one line without control characters, whatever it quotes.
inline void check_one_line(std::string_view text) {
  const auto is_control = [](unsigned char c) { return c < ' ' || c == 0x7f; };
  CHECK_EQ(std::count_if(text.begin(), text.end(), is_control), 0);
  CHECK_GT(text.size(), std::size_t{0});
}

// The same for an error in a file: the message begins with the file's name.
inline void check_message(std::string_view text, std::string_view file) {
  check_one_line(text);
  CHECK_EQ(text.substr(0, file.size() + 1), std::string(file) + ':');
}

}  // namespace salbench
