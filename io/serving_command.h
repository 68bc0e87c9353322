// SPDX-License-Identifier: GPL-3.0-or-later
// A command that is started once and asked many times.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>

namespace salbench {

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
  // run_command does; the command is of no use then.
  bool ask(const std::string& line, const std::string& answer, std::chrono::duration<double> timeout);

  std::string last_lines() const;  // of what it printed since it was asked, for a message

 private:
  class Running;
  std::unique_ptr<Running> running_;
};

}  // namespace salbench
