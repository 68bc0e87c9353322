// SPDX-License-Identifier: GPL-3.0-or-later
// Descendants are found by their parents' numbers in /proc, several times, since they fork while they are
// looked for. A process that is to be killed forks no more, and the children of a dead one become ours, so
// that nothing gets away. A process without children has no descendants, which needs no look at /proc.
#include "io/descendants.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>
#include <unordered_set>
#include <vector>

#include <dirent.h>
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/descriptor.h"

namespace salbench {
namespace {

constexpr std::chrono::seconds kPatience(10);
constexpr std::chrono::milliseconds kFirstPause(1), kLongestPause(50);  // between two looks

// 0 for one that is gone. In "7 (a name) S 1 ..." the name may hold anything.
pid_t parent_of(const char* number) {
  const Descriptor file(::open(("/proc/" + std::string(number) + "/stat").c_str(), O_RDONLY | O_CLOEXEC));
  std::array<char, 512> line{};
  if (::read(file.get(), line.data(), line.size() - 1) <= 0) return 0;
  const std::string text(line.data());
  const std::size_t name_end = text.rfind(") ");
  return name_end == std::string::npos ? 0 : static_cast<pid_t>(std::atol(text.c_str() + name_end + 4));
}

struct Process {
  pid_t number, parent;
};

std::vector<Process> all_processes() {
  std::vector<Process> all;
  const std::unique_ptr<DIR, int (*)(DIR*)> listed(::opendir("/proc"), ::closedir);
  while (const dirent* entry = listed ? ::readdir(listed.get()) : nullptr)
    if (const auto number = static_cast<pid_t>(std::atol(entry->d_name)); number > 0)
      all.push_back({number, parent_of(entry->d_name)});
  return all;
}

// Reaps the dead children.
bool any_child_lives() {
  pid_t reaped = 0;
  do reaped = ::waitpid(-1, nullptr, WNOHANG);
  while (reaped > 0);
  return reaped == 0;
}

}  // namespace

void signal_descendants(int signal) {
  const std::vector<Process> all = all_processes();
  std::unordered_set<pid_t> family = {::getpid()};
  for (std::size_t before = 0; before != family.size();) {
    before = family.size();
    for (const Process& process : all)
      if (family.contains(process.parent) && family.insert(process.number).second)
        ::kill(process.number, signal);
  }
}

void end_descendants() {
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  for (auto pause = kFirstPause; any_child_lives() && std::chrono::steady_clock::now() < deadline;
       pause = std::min(2 * pause, kLongestPause)) {
    signal_descendants(SIGKILL);
    std::this_thread::sleep_for(pause);
  }
}

}  // namespace salbench
