// Subcommand `export`: everything known of some items, as files that other programs open.
#pragma once

#include "pipeline/commands/subcommand.h"

namespace salbench {

Subcommand export_subcommand(Arguments& arguments);

}  // namespace salbench
