// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/commands/interrupt.h"

#include <csignal>
#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

#include "io/commands/process.h"

namespace salbench {
namespace {

// A signal handler may touch lock-free atomics, and text that no longer changes.
std::atomic<bool> asked = false;
std::atomic<int> orderly_ends = 0;
std::string farewell;
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

void on_second_signal(int signal) {
  std::signal(signal, SIG_DFL);
  std::raise(signal);  // delivered when the handler returns
}

void on_signal(int signal) {
  if (orderly_ends > 0 && !asked) {
    asked = true;
    // A terminal that goes says so twice, by the system and by its shell.
    std::signal(signal, signal == SIGHUP ? SIG_IGN : on_second_signal);
    end_commands();
    return;
  }
  // Nothing can be done about a standard error that takes no text.
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, farewell.data(), farewell.size());
  ::_exit(kInterrupted);
}

}  // namespace

void handle_interrupts(const std::string& command_line) {
  farewell =
      fmt::format("\ninterrupted; everything finished so far is kept. To go on:\n  {}\n", command_line);
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  if (std::signal(SIGHUP, on_signal) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);  // nohup
}

OrderlyEnd::OrderlyEnd() { ++orderly_ends; }
OrderlyEnd::~OrderlyEnd() { --orderly_ends; }

const std::atomic<bool>& interrupted() { return asked; }

// std::fputs in place of fmt::print, which throws if standard error takes no text.
ExitStatus interrupted_status() {
  std::fputs(farewell.c_str(), stderr);
  return kInterrupted;
}

}  // namespace salbench
