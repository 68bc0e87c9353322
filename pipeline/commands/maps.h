// Subcommand `maps`: saliency maps as text files.
#pragma once

#include "pipeline/commands/subcommand.h"

namespace salbench {

Subcommand maps_subcommand(Arguments& arguments);

}  // namespace salbench
