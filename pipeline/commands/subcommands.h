// SPDX-License-Identifier: GPL-3.0-or-later
// The room of the command line. Words come in; a subcommand, its output and its exit status go out. Each has
// a row in the table (program.cpp); session.h is the way from their arguments to a run. It includes
// everything, and alone CLI11; nothing includes it.
//
// Here: who calls each subcommand, and when. `salbench NAME --help` says what it does.
#pragma once

#include <span>

#include "pipeline/commands/subcommand.h"

namespace salbench {

// Everybody: the benchmark of a configuration, and again after any change or interruption. Authors of a model
// whose maps are made already: its scores beside the others'.
Subcommand run_subcommand(Arguments& arguments);
// Whoever goes on in Python or a viewer, or archives a study: when the run is done.
Subcommand export_subcommand(Arguments& arguments);
// Before a long run, to see what it would compute, why, and whether the disk has room; during one, from
// another terminal. Whoever changes the table of rules: its graph.
Subcommand plan_subcommand(Arguments& arguments);
// Whoever sees more computed than expected.
Subcommand explain_subcommand(Arguments& arguments);
// Whoever writes a configuration, for what there is to choose.
Subcommand config_subcommand(Arguments& arguments);
// Owners of a cache, after trouble with a disk, and before results are published.
Subcommand verify_subcommand(Arguments& arguments);
// Owners of a cache, when the disk fills up.
Subcommand gc_subcommand(Arguments& arguments);

std::span<const SubcommandRow> subcommand_rows();  // THE table of them, in program.cpp

// From the command line to a subcommand and its exit status. Every error is said on standard error, and every
// way to end is an ExitStatus. An output that cannot be written to its end is an error.
int run_program(int argc, const char* const* argv, std::span<const SubcommandRow> rows);

}  // namespace salbench
