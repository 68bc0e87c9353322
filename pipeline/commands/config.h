// Subcommand `config`: the complete configuration, with what each option means.
#pragma once

#include "pipeline/commands/subcommand.h"

namespace salbench {

Subcommand config_subcommand(Arguments& arguments);

}  // namespace salbench
