// Subcommand `status`: what is in the cache, and whether the results are complete.
#pragma once

#include "pipeline/commands/subcommand.h"

namespace salbench {

Subcommand status_subcommand(Arguments& arguments);

}  // namespace salbench
