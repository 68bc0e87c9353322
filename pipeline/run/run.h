// SPDX-License-Identifier: GPL-3.0-or-later
// Runs and their results.
#pragma once

#include <string>
#include <vector>

#include "io/table.h"
#include "pipeline/run/session.h"

namespace salbench {

// Computes what is missing and writes the score tables, with the finished part if interrupted. Returns their
// digest; empty if there are none: for a share, or before the first score.
std::string run_and_write(Session& session, int threads);

Table means_of(Session& session);  // as in means.csv

}  // namespace salbench
