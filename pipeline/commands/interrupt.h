// SPDX-License-Identifier: GPL-3.0-or-later
// Ctrl-C, SIGTERM and the SIGHUP of a terminal or a connection that goes. What is in the cache has its name
// or is not there, so that a command may end at any moment; only what would leave something half done in the
// user's folders, or throw running work away, is brought to an orderly end.
#pragma once

#include <atomic>
#include <string>

namespace salbench {

enum ExitStatus {
  kAllDone = 0,
  kSomeFailed = 1,
  kUnusableArguments = 2,  // or configuration
  // Cache, output folder or standard output; or the system has no memory or thread to begin with.
  kUnusableStorage = 3,
  kDefect = 70,  // of the program, or memory ran out in a job; as in sysexits.h
  kInterrupted = 130,
};

// Once, at the start, with the line that was typed, which resumes. Outside of an OrderlyEnd the first signal
// ends the program at once, with that line on standard error.
void handle_interrupts(const std::string& command_line);

// While one lives, the first signal only sets the flag, and the second one ends the program.
class OrderlyEnd {
 public:
  OrderlyEnd();
  OrderlyEnd(const OrderlyEnd&) = delete;
  OrderlyEnd& operator=(const OrderlyEnd&) = delete;
  ~OrderlyEnd();
};

const std::atomic<bool>& interrupted();  // the flag
ExitStatus interrupted_status();         // says how to go on

}  // namespace salbench
