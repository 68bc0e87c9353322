// SPDX-License-Identifier: GPL-3.0-or-later
// Subcommand `run`: computes what is missing and writes the tables.
#pragma once

#include <optional>
#include <string>

#include "pipeline/commands/output_folder.h"
#include "pipeline/commands/report.h"
#include "pipeline/commands/session.h"

namespace salbench {

// Computes what is missing and writes the tables of scores; when interrupted, those of what was finished.
// Returns the digest that names them, empty if there are none: of a shard, or before the first score. output:
// that of the session, held by this call as long as the object lives; none of a shard.
std::string run_and_write(Session& session, int threads, std::optional<OutputFolder>& output);

// What a session did, for the document that it ends with: shapes, models, artefacts computed, failures, and
// whether a signal ended it.
Json summary_of(const Session& session);

}  // namespace salbench
