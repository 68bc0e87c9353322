// SPDX-License-Identifier: GPL-3.0-or-later
// A signal to a group reaches all of it at once, also what its processes are just about to start; so the
// members of a session, found in /proc, are signalled by their groups.
#include "io/commands/session.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <set>
#include <string>
#include <thread>

#include <dirent.h>
#include <fcntl.h>
#include <sys/prctl.h>
#include <unistd.h>

#include "io/commands/scratch_folder.h"
#include "io/descriptor.h"

namespace salbench {
namespace {

constexpr std::chrono::seconds kPatience(10);
constexpr std::chrono::milliseconds kFirstPause(1), kLongestPause(50);  // between two looks

struct Membership {
  pid_t group = 0, session = 0;  // 0: it is dead or gone
};

// In "7 (a name) S 1 7 7 ..." the name may hold anything: state, parent, group and session stand behind it.
Membership membership_of(const char* process) {
  const Descriptor file(::open(("/proc/" + std::string(process) + "/stat").c_str(), O_RDONLY | O_CLOEXEC));
  std::array<char, 512> line{};
  if (::read(file.get(), line.data(), line.size() - 1) <= 0) return {};
  const std::string text(line.data());
  const std::size_t name_end = text.rfind(") ");
  char state = 'X';
  int parent = 0;
  Membership found;
  if (name_end == std::string::npos || std::sscanf(text.c_str() + name_end + 2, "%c %d %d %d", &state,
                                                   &parent, &found.group, &found.session) != 4)
    return {};
  return state == 'Z' || state == 'X' ? Membership() : found;
}

}  // namespace

// The group of the first process is signalled unseen: one that is always about to replace itself may be in no
// listing of /proc.
bool signal_session(pid_t session, int signal) {
  ::kill(-session, signal);
  std::set<pid_t> signalled = {session};
  bool any = false;
  const std::unique_ptr<DIR, int (*)(DIR*)> listed(::opendir("/proc"), ::closedir);
  while (const dirent* entry = listed ? ::readdir(listed.get()) : nullptr) {
    if (std::atol(entry->d_name) <= 0) continue;
    const Membership found = membership_of(entry->d_name);
    if (found.session != session) continue;
    any = true;
    if (signalled.insert(found.group).second) ::kill(-found.group, signal);
  }
  return any;
}

void kill_session(pid_t session) {
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  for (auto pause = kFirstPause;
       signal_session(session, SIGKILL) && std::chrono::steady_clock::now() < deadline;
       pause = std::min(2 * pause, kLongestPause))
    std::this_thread::sleep_for(pause);
}

void run_guard(int told) try {
  ::setsid();
  ::prctl(PR_SET_NAME, "command-guard");  // `killall salbench` must not end it
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE}) std::signal(signal, SIG_IGN);
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  // All other descriptors would stay open as long as it lives: ends of pipes, locks.
  ::dup2(told, STDIN_FILENO);
  ::closefrom(STDIN_FILENO + 1);
  for (int i = 0; i < 2; ++i) static_cast<void>(::open("/dev/null", O_RDWR));

  std::set<pid_t> sessions;
  std::array<char, 16> text;
  for (ssize_t got = 0;
       (got = ::read(STDIN_FILENO, text.data(), text.size())) > 0 || (got < 0 && errno == EINTR);) {
    pid_t number = 0;
    if (got < 0 || std::from_chars(text.data(), text.data() + got, number).ec != std::errc()) continue;
    if (number > 0) sessions.insert(number);
    if (number < 0) sessions.erase(-number);
    if (number == kAskToEnd)
      for (const pid_t session : sessions) signal_session(session, SIGTERM);
  }
  for (const pid_t session : sessions) kill_session(session);
  remove_abandoned_scratch();
  ::_exit(0);
} catch (...) {
  ::_exit(1);
}

}  // namespace salbench
