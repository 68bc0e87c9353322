// SPDX-License-Identifier: GPL-3.0-or-later
// Commands that the program runs for a result: their output, their time, and their end.
#pragma once

#include <chrono>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace salbench {

// Starts the process that commands are started from, a copy of this one: for a moment when the program is
// small, since the first command does it otherwise. Throws StorageError.
void prepare_commands();

// Runs `/bin/sh -c command` in the folder, without a terminal, with nothing to read and its output kept from
// the terminal. When it returns or throws, no process that the command started is left, in whatever group or
// session; the same holds when the program ends, however it does. Throws InputError if the command fails or
// takes longer than the timeout: one line with the reason and the last lines of its output;
// Interrupted after end_commands; StorageError if the system has no process or pipe for it.
void run_command(const std::string& command, const std::filesystem::path& folder,
                 std::chrono::duration<double> timeout);

// End of a command that may fail.
struct CommandEnd {
  int status = 0;            // 128 + the signal that killed it, as shells have it
  std::string reason = {};   // one line: why it failed; empty if it did not
  std::string printed = {};  // its last lines, as one
};

// The same for a command whose failure is an answer: throws InputError only if it takes too long.
CommandEnd try_command(const std::string& command, const std::filesystem::path& folder,
                       std::chrono::duration<double> timeout);

std::string said_of(const std::string& printed);  // as a part of a message

// Sends SIGTERM to all commands at work, and from now on starts none. Safe in a signal handler.
void end_commands();
bool commands_are_ended();
// Commands may be started again; none is at work. For a process that goes on after an interrupt.
void allow_commands();

// A word that the shell reads as this text.
std::string shell_quoted(const std::string& text);

}  // namespace salbench
