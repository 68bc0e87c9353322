// SPDX-License-Identifier: GPL-3.0-or-later
// The libraries that results and times depend on.
#pragma once

#include <string>
#include <vector>

namespace salbench {

// "oneTBB 2021.8.0", of the libraries that are loaded; "(built with 2021.7)" behind it if the headers were
// others.
std::vector<std::string> libraries();

}  // namespace salbench
