// SPDX-License-Identifier: GPL-3.0-or-later
// A run with its results.
#pragma once

#include <string>
#include <vector>

#include "io/table.h"
#include "pipeline/run/session.h"

namespace salbench {

// Computes what is missing and writes the tables of scores; when interrupted, those of what was finished.
// Returns the digest that names them, empty if there are none: of a share, or before the first score.
std::string run_and_write(Session& session, int threads);

Table means_of(Session& session);  // as means.csv has them

}  // namespace salbench
