// SPDX-License-Identifier: GPL-3.0-or-later
// Files that ship with the program, found wherever it is installed.
#pragma once

#include <span>
#include <string_view>

namespace salbench {

struct NamedYaml {
  std::string_view name;  // file name without .yaml
  std::string_view yaml;
};
std::span<const NamedYaml> configurations();  // files of configs and of configs/protocols ("protocols/3dva")

}  // namespace salbench
