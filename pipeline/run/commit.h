// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace salbench {

// The commit that the program was built from, "... with changes" if files differed from it; empty if neither
// git nor the archive of the sources said it.
std::string_view commit();

}  // namespace salbench
