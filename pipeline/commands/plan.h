// Subcommand `plan`: what a run would compute, and why.
#pragma once

#include "pipeline/commands/subcommand.h"

namespace salbench {

Subcommand plan_subcommand(Arguments& arguments);

}  // namespace salbench
