// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace salbench {

// Versions of a library that is loaded when the program starts, which need not be the one it was built with.
struct LibraryVersion {
  std::string built, loaded;
};

}  // namespace salbench
