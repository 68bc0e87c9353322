// SPDX-License-Identifier: GPL-3.0-or-later
// The subcommands, each in the file of its name. THE table of them is in program.cpp.
#pragma once

#include "pipeline/commands/subcommand.h"

namespace salbench {

Subcommand run_subcommand(Arguments& arguments);
Subcommand maps_subcommand(Arguments& arguments);
Subcommand evaluate_subcommand(Arguments& arguments);
Subcommand export_subcommand(Arguments& arguments);
Subcommand pictures_subcommand(Arguments& arguments);
Subcommand conclusions_subcommand(Arguments& arguments);
Subcommand power_subcommand(Arguments& arguments);
Subcommand plan_subcommand(Arguments& arguments);
Subcommand graph_subcommand(Arguments& arguments);
Subcommand explain_subcommand(Arguments& arguments);
Subcommand status_subcommand(Arguments& arguments);
Subcommand config_subcommand(Arguments& arguments);
Subcommand verify_subcommand(Arguments& arguments);
Subcommand gc_subcommand(Arguments& arguments);

}  // namespace salbench
