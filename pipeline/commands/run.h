// SPDX-License-Identifier: GPL-3.0-or-later
// Subcommand `run`: computes what is missing and writes the tables.
#pragma once

#include <functional>
#include <string>

#include "pipeline/commands/report.h"
#include "pipeline/commands/session.h"

namespace salbench {

// Callback with the conclusions of a finished run; a shard has none.
using Show = std::function<void(const Conclusions&)>;

// Computes what is missing and writes the tables; when interrupted, those of what was finished.
void carry_out(Session& session, int threads, const Show& show = {});

// The same as a command of this name, with what it prints.
ExitStatus run_session(Session& session, const std::string& name, const Arguments& arguments,
                       ReportFormat format);

}  // namespace salbench
