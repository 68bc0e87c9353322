// SPDX-License-Identifier: GPL-3.0-or-later
// Subcommand `graph`: the flow graph that a configuration runs.
#pragma once

#include <string>
#include <vector>

#include "pipeline/plan/plan.h"

namespace salbench {

// Text with one line per node, or Graphviz with `dot`. `to_do` has the open jobs of each row; empty: not
// known.
std::string graph_text(const Catalog& catalog, const std::vector<std::size_t>& to_do = {});
std::string graph_dot(const Catalog& catalog, const std::vector<std::size_t>& to_do = {});

}  // namespace salbench
