// The subcommands of the program.
#pragma once

#include <atomic>

#include "pipeline/session.h"

namespace salbench {

enum ExitStatus {
  kAllDone = 0,
  kSomeFailed = 1,
  kUnusableArguments = 2,  // or configuration
  kUnusableStorage = 3,    // cache or output folder
  kDefect = 70,            // of the program, or memory ran out; as in sysexits.h
  kInterrupted = 130,
};

// Each throws ConfigError, InputError or StorageError for what makes the whole command impossible.
ExitStatus run_command(const Arguments& arguments, const std::atomic<bool>& stop);
ExitStatus maps_command(const Arguments& arguments, const std::atomic<bool>& stop);
ExitStatus plan_command(const Arguments& arguments);
ExitStatus status_command(const Arguments& arguments);

// Carries a session out and writes the tables.
ExitStatus run_session(Session& session, const Arguments& arguments, const std::atomic<bool>& stop);

// The end of a subcommand that computes: each says on stderr what the user must know.
std::string interrupted_text(const Arguments& arguments);
ExitStatus interrupted_status(const Arguments& arguments);
ExitStatus finished_status(const Session& session);  // whether all succeeded

}  // namespace salbench
