// SPDX-License-Identifier: GPL-3.0-or-later
// From the command line to a subcommand and its exit status.
#pragma once

#include <span>

#include "pipeline/commands/subcommand.h"

namespace salbench {

std::span<const SubcommandRow> subcommand_rows();  // THE table of subcommands

// Every error is said on standard error, and every way to end is an ExitStatus. An output that cannot be
// written to its end is an error.
int run_program(int argc, const char* const* argv, std::span<const SubcommandRow> rows);

}  // namespace salbench
