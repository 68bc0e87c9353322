// SPDX-License-Identifier: GPL-3.0-or-later
// Commands that the program runs for a result: their output, their time, and their end.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>

#include "stages/core/errors.h"

namespace salbench {

// A command was ended by a signal that nothing in it raises: by a person, or a system without memory.
struct EndedFromOutside : InputError {
  using InputError::InputError;
};

// Starts the guard, a copy of this process that ends the commands of a program that was killed: for a moment
// when the program is small, since the first command does it otherwise. Throws StorageError.
void prepare_commands();

// A command was not done within its timeout.
struct TookTooLong : InputError {
  using InputError::InputError;
};

// Runs `/bin/sh -c command` in the folder, in a session of its own without a terminal, with nothing to read
// and its output kept from the terminal. When it returns or throws, no process of that session is left; the
// same holds when the program ends, however it does. Throws InputError if the command fails or takes longer
// than the timeout: one line with the reason and the last lines of its output; Interrupted after
// end_commands; StorageError if the system has no process or pipe for it.
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

// A command that stays at work, so that what it needs is loaded once: it reads lines from its standard input,
// and prints another line on its standard output when it is done with each. One thread at a time may use it.
class ServingCommand {
 public:
  // Starts the command as run_command does. Throws Interrupted after end_commands, and StorageError.
  ServingCommand(const std::string& command, const std::filesystem::path& folder);
  ServingCommand(const ServingCommand&) = delete;
  ServingCommand& operator=(const ServingCommand&) = delete;
  // Closes what it reads; two seconds later, or at once after a failure, all its processes are ended.
  ~ServingCommand();

  bool has_ended();
  bool has_answered() const;  // any line
  std::string failure();      // why it did not end well, empty if it did; after it has ended

  // Writes the line, and waits until the command prints `answer` as a whole line. What else it prints counts
  // for messages only. False if the line is not to blame for its end: it ended with status 0, or, after
  // other answers, without reading the line. Otherwise throws InputError and Interrupted as
  // run_command does, or EndedFromOutside; the command is of no use then.
  bool ask(const std::string& line, const std::string& answer, std::chrono::duration<double> timeout);

  std::string last_lines() const;  // of what it printed since it was asked, for a message

 private:
  class Running;
  std::unique_ptr<Running> running_;
};

std::string said_of(const std::string& printed);  // as a part of a message

// Has SIGTERM sent to all commands at work, and from now on starts none. Safe in a signal handler.
void end_commands();
bool commands_are_ended();
// Commands may be started again; none is at work. For a process that goes on after an interrupt.
void allow_commands();

// A word that the shell reads as this text.
std::string shell_quoted(const std::string& text);

}  // namespace salbench
