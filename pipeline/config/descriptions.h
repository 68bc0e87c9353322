// SPDX-License-Identifier: GPL-3.0-or-later
// The files of configs/datasets, which the build makes part of the program: it finds them wherever it runs.
#pragma once

#include <span>
#include <string_view>

namespace salbench {

struct Description {
  std::string_view name;  // of the file, without .yaml
  std::string_view yaml;
};
std::span<const Description> descriptions();  // by name

}  // namespace salbench
