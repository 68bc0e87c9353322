// SPDX-License-Identifier: GPL-3.0-or-later
// The processes of a command. The shell leads a session of its own. The program ends the whole session when
// the command ends, times out or is interrupted; if the program is gone, its guard does.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "io/descriptor.h"

namespace salbench {

// `/bin/sh -c command`, until it and its session are gone: with this object at the latest.
class Shell {
 public:
  // Input below 0: nothing to read. Throws StorageError, and InputError for a command that is too long.
  Shell(const std::string& command, const std::filesystem::path& folder, int input, int output, int errors);
  Shell(const Shell&) = delete;
  Shell& operator=(const Shell&) = delete;
  ~Shell();

  void terminate() const;                        // SIGTERM to all of the session
  int descriptor() const { return end_.get(); }  // polls as readable when the shell has ended
  // As of waitpid, once the shell has ended; then no process of its session is left.
  std::optional<int> end();

 private:
  void finish();

  pid_t shell_ = -1;
  Descriptor end_{-1};
  std::optional<int> status_;
};

int ending_descriptor();  // polls as readable from end_commands to allow_commands; -1: no command was started

// Throws StorageError with errno's reason: the system has none left.
[[noreturn]] void fail_for_lack(const char* of);

}  // namespace salbench
