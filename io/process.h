// SPDX-License-Identifier: GPL-3.0-or-later
// Commands that the program runs for a result: their folder, their output, their time, and their end.
#pragma once

#include <chrono>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace salbench {

// A new folder below TMPDIR, removed with all that is in it. Throws StorageError.
class ScratchFolder {
 public:
  ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder();

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

// The program was asked to end while a command was at work: nothing is known about the command.
struct CommandInterrupted : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Runs `/bin/sh -c command` in the folder, as a process group of its own, with nothing to read and its output
// kept from the terminal. When it returns or throws, no process of the group is left. Throws InputError if
// the command fails or takes longer than the timeout: one line with the reason and the last lines of its
// output; CommandInterrupted after end_commands; StorageError if the system has no process or pipe for it.
void run_command(const std::string& command, const std::filesystem::path& folder,
                 std::chrono::duration<double> timeout);

// Ends all commands at work with the signal, and from now on starts none. Safe in a signal handler.
void end_commands(int signal);

// A word that the shell reads as this text.
std::string shell_quoted(const std::string& text);

}  // namespace salbench
