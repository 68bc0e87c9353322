// Subcommand `evaluate`: a run in which saliency maps made elsewhere stand beside the models of the
// configuration.
#pragma once

#include "pipeline/commands/subcommand.h"

namespace salbench {

Subcommand evaluate_subcommand(Arguments& arguments);

}  // namespace salbench
