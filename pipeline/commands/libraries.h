// SPDX-License-Identifier: GPL-3.0-or-later
// The libraries that results and times depend on.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace salbench {

struct Library {
  std::string name, built;            // the version of its headers
  std::optional<std::string> loaded;  // nothing: its code is all in the headers, or it does not say
};
std::vector<Library> libraries();

}  // namespace salbench
