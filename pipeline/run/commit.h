// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace salbench {

// Commit that the program was built from, followed by "with changes" if files differed; empty if neither git
// nor the source archive provides it.
std::string_view commit();

}  // namespace salbench
