// SPDX-License-Identifier: GPL-3.0-or-later
// What the standard library throws where the system refuses something.
#pragma once

#include <string>
#include <system_error>

namespace salbench {

// The file and why, or why there is no thread, and what to do about it.
std::string text_of(const std::system_error& refusal);

}  // namespace salbench
