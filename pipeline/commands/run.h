// SPDX-License-Identifier: GPL-3.0-or-later
// Subcommand `run`: computes what is missing and writes the tables.
#pragma once

#include <string>

#include "pipeline/commands/report.h"
#include "pipeline/commands/session.h"

namespace salbench {

// Computes what is missing and writes the tables of scores; when interrupted, those of what was finished.
// Returns the digest that names them, empty if there are none: of a shard, or before the first score.
std::string run_and_write(Session& session, int threads);

// What a session did, for the document that it ends with: shapes, models, artefacts computed, failures, and
// whether a signal ended it.
Json summary_of(const Session& session);

}  // namespace salbench
