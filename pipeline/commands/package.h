// SPDX-License-Identifier: GPL-3.0-or-later
// The Python package of this version, and its subcommands, which the program hands over.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace salbench {

struct PackageSubcommand {
  std::string_view name, summary;
};

// THE list of them; a test compares it with that of the package (python/salbench/__main__.py).
std::span<const PackageSubcommand> package_subcommands();

// Turns this process into the package's, so that signals and exit status are its own. The words are those
// behind the program's name. Throws ConfigError if there is no interpreter.
[[noreturn]] void become_package(std::span<const char* const> words);

// A line for /bin/sh that runs a subcommand of the package. It ends with this status, and one line that says
// what to install, if the interpreter has no package of this version.
inline constexpr int kNoPackage = 69;  // EX_UNAVAILABLE of sysexits.h
std::string package_command(const std::vector<std::string>& words);

// The same line where there is no interpreter at all.
std::string no_interpreter(std::string_view reason);

}  // namespace salbench
