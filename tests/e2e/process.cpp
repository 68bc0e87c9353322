// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/e2e/process.h"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/file.h"

namespace salbench {

Process::Process(const std::vector<std::string>& command) {
  std::vector<char*> arguments;
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  constexpr int kCreate = O_WRONLY | O_CREAT | O_TRUNC;
  const std::string out = (outputs_ / "out").string(), err = (outputs_ / "err").string();
  ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), kCreate, 0666);
  ::posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(), kCreate, 0666);
  // Whatever starts the tests (nohup, a script in the background) may have had them ignored.
  sigset_t usual;
  ::sigemptyset(&usual);
  for (const int signal : {SIGHUP, SIGINT, SIGQUIT, SIGPIPE, SIGTERM}) ::sigaddset(&usual, signal);
  posix_spawnattr_t attributes;
  ::posix_spawnattr_init(&attributes);
  ::posix_spawnattr_setsigdefault(&attributes, &usual);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
  const int error = ::posix_spawn(&pid_, arguments[0], &actions, &attributes, arguments.data(), environ);
  ::posix_spawnattr_destroy(&attributes);
  ::posix_spawn_file_actions_destroy(&actions);
  if (error != 0) throw std::system_error(error, std::generic_category(), command[0]);
}

Process::~Process() {
  if (reaped_) return;
  send(SIGKILL);
  ::waitpid(pid_, nullptr, 0);
}

void Process::send(int signal) const { ::kill(pid_, signal); }

bool Process::ended() {
  if (!reaped_) reaped_ = ::waitpid(pid_, &raw_status_, WNOHANG) == pid_;
  return reaped_;
}

bool Process::stopped() const {
  siginfo_t info{};
  return ::waitid(P_PID, static_cast<id_t>(pid_), &info, WSTOPPED | WNOHANG | WNOWAIT) == 0 &&
         info.si_pid == pid_;
}

Outcome Process::wait() {
  while (!reaped_) {
    if (::waitpid(pid_, &raw_status_, 0) == pid_)
      reaped_ = true;
    else if (errno != EINTR)
      throw std::system_error(errno, std::generic_category(), "waitpid");
  }
  const int status = WIFEXITED(raw_status_) ? WEXITSTATUS(raw_status_) : 128 + WTERMSIG(raw_status_);
  return {status, read_file(outputs_ / "out"), read_file(outputs_ / "err")};
}

bool wait_until(Process& process, const std::function<bool()>& condition) {
  while (!condition()) {
    if (process.ended()) return condition();
    std::this_thread::sleep_for(std::chrono::microseconds(200));  // a core for the program
  }
  return true;
}

std::vector<std::string> with_signal_at_rename(std::vector<std::string> command, const std::string& moment,
                                               int signal) {
  command.insert(command.begin(),
                 {"/usr/bin/env", "LD_PRELOAD=" SALBENCH_KILL_AT_RENAME, "SALBENCH_KILL_AT=" + moment,
                  "SALBENCH_KILL_BY=" + std::to_string(signal), "ASAN_OPTIONS=verify_asan_link_order=0",
                  "PYTHONDONTWRITEBYTECODE=1"});  // which renames files, too
  return command;
}

}  // namespace salbench
