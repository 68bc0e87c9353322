// SPDX-License-Identifier: GPL-3.0-or-later
// The document that a subcommand which computes ends with under --format json (docs/json.md).
#pragma once

#include "io/table.h"
#include "pipeline/commands/report.h"
#include "pipeline/commands/session.h"

namespace salbench {

// What a session did: shapes, models, artefacts computed, failures, and whether a signal ended it.
Json summary_of(const Session& session);

// The rows of a table; cells are texts as its CSV file has them.
Json rows_json(const Table& table);

}  // namespace salbench
