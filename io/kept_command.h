// SPDX-License-Identifier: GPL-3.0-or-later
// A command that ends with all its processes: with this object, or when the program ends, however it does.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "io/command_launcher.h"
#include "io/descriptor.h"

namespace salbench {

// Throws StorageError with errno's reason: the system has none left.
[[noreturn]] void fail_for_lack(const char* of);

struct CommandFiles {
  int output, errors;
  int input = -1;  // -1: nothing to read
};

class KeptCommand {
 public:
  // `/bin/sh -c command` in a folder, without a terminal. Throws StorageError.
  KeptCommand(const std::string& command, const std::filesystem::path& folder, const CommandFiles& files);
  KeptCommand(const KeptCommand&) = delete;
  KeptCommand& operator=(const KeptCommand&) = delete;
  ~KeptCommand();  // returns when none of its processes is left

  void terminate();  // SIGTERM to all of them

  // Once the shell has ended and no process is left. One whose keeper was killed counts as killed.
  std::optional<KeptEnd> end();

  int descriptor() const { return control_.get(); }  // polls as readable when it has ended
  static int ending_descriptor();                    // polls as readable after end_commands

 private:
  Descriptor control_{-1};
  std::optional<KeptEnd> end_;
};

}  // namespace salbench
