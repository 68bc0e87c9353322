// SPDX-License-Identifier: GPL-3.0-or-later
// Subcommands of the Python package, which the program hands over.
#pragma once

#include <span>
#include <string_view>

namespace salbench {

struct PackageSubcommand {
  std::string_view name, summary;
};

// THE list of them; a test compares it with that of the package (python/salbench/__main__.py).
std::span<const PackageSubcommand> package_subcommands();

// Turns this process into the package's, so that signals and exit status are its own. The words are those
// behind the program's name. Throws ConfigError if there is no interpreter.
[[noreturn]] void become_package(std::span<const char* const> words);

}  // namespace salbench
