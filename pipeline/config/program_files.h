// SPDX-License-Identifier: GPL-3.0-or-later
// Files that are a part of the program, which finds them wherever it lies.
#pragma once

#include <span>
#include <string_view>

namespace salbench {

struct NamedYaml {
  std::string_view name;  // of the file, without .yaml
  std::string_view yaml;
};
std::span<const NamedYaml> configurations();  // those of configs and of configs/protocols ("protocols/3dva")

}  // namespace salbench
