// SPDX-License-Identifier: GPL-3.0-or-later
// Messages for what the system refuses: a file, or a thread.
#pragma once

#include <string>
#include <system_error>

namespace salbench {

// The file and why, or why there is no thread, and what to do about it.
std::string refusal_text(const std::system_error& refusal);

}  // namespace salbench
