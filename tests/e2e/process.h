// SPDX-License-Identifier: GPL-3.0-or-later
// A program run beside the test: what it was told, what it said, and how it ended.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <sys/types.h>

#include "tests/support/temporary_folder.h"

namespace salbench {

struct Outcome {
  int status = 0;  // exit status; 128 + the signal where one ended the program, as shells have it
  std::string out, err;
};

// Started at once and killed with the object. The outputs go to files, so a silent reader never blocks the
// program.
class Process {
 public:
  explicit Process(const std::vector<std::string>& command);  // command[0]: path of the program
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  ~Process();

  void send(int signal) const;
  bool ended();          // without waiting
  bool stopped() const;  // by SIGSTOP; without waiting
  Outcome wait();        // for the end

 private:
  TemporaryFolder outputs_;
  pid_t pid_ = 0;
  int raw_status_ = 0;
  bool reaped_ = false;
};

// Waits for a condition that the process is certain to bring about, and that stays: however long that takes
// on a busy machine. False if the process ends without it.
bool wait_until(Process& process, const std::function<bool()>& condition);

// The command, sent the signal by itself at one of its renames: "3 before", "3 after" (kill_at_rename.cpp).
std::vector<std::string> with_signal_at_rename(std::vector<std::string> command, const std::string& moment,
                                               int signal);

inline Outcome run_process(const std::vector<std::string>& command) { return Process(command).wait(); }

}  // namespace salbench
