// SPDX-License-Identifier: GPL-3.0-or-later
// The manual page and the shell's completion, made from the table of subcommands.
#pragma once

#include <span>
#include <string>

#include "pipeline/commands/subcommand.h"

namespace salbench {

// salbench(1), in the macros of man(7). `date` is that of the version, as 2026-11-21.
std::string manual_page(std::span<const SubcommandRow> rows, const std::string& version,
                        const std::string& date);

// A script that bash sources: subcommands, their options, and the names of installed configurations.
std::string bash_completion(std::span<const SubcommandRow> rows);

}  // namespace salbench
