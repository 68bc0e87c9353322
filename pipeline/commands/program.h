// SPDX-License-Identifier: GPL-3.0-or-later
// The room of the command line. Words come in; a subcommand, its output and its exit status go out. Each has
// the file of its name and a row in the table (program.cpp); session.h is the way from their arguments to a
// run. It includes everything, and alone CLI11; nothing includes it.
#pragma once

#include <span>

#include "pipeline/commands/subcommand.h"

namespace salbench {

std::span<const SubcommandRow> subcommand_rows();  // THE table of subcommands

// Every error is said on standard error, and every way to end is an ExitStatus. An output that cannot be
// written to its end is an error.
int run_program(int argc, const char* const* argv, std::span<const SubcommandRow> rows);

}  // namespace salbench
