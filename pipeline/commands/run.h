// SPDX-License-Identifier: GPL-3.0-or-later
// Subcommand `run`: computes what is missing and writes the tables.
#pragma once

#include <atomic>

#include "pipeline/commands/session.h"

namespace salbench {

// Carries a session out and writes the tables; when interrupted, those of what was finished.
ExitStatus run_session(Session& session, const Arguments& arguments, const std::atomic<bool>& stop);

}  // namespace salbench
