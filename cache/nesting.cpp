// SPDX-License-Identifier: GPL-3.0-or-later
// The thread claims its own name while it is in a function; others ask for the names of the threads above
// them. Where these are, Linux says: the parent of each process, and the children of each thread.
#include "cache/nesting.h"

#include <fstream>
#include <string>
#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

namespace salbench {
namespace {

namespace fs = std::filesystem;

// The same in no other machine or container that shares the cache.
std::string name_of(pid_t process, pid_t thread) {
  std::error_code unknown;
  std::string machine;
  std::getline(std::ifstream("/proc/sys/kernel/random/boot_id"), machine);
  return fmt::format("function of {} {} {} {}", machine,
                     fs::read_symlink("/proc/self/ns/pid", unknown).string(), process, thread);
}

pid_t parent_of(pid_t process) {
  std::ifstream status(fmt::format("/proc/{}/status", process));
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("PPid:")) return static_cast<pid_t>(std::stol(line.substr(5)));
  return 0;
}

// The thread of its parent that has started a process; 0 if that is not known.
pid_t thread_that_started(pid_t process, pid_t parent) {
  std::error_code error;
  for (fs::directory_iterator it(fmt::format("/proc/{}/task", parent), error), end; !error && it != end;
       it.increment(error)) {
    std::ifstream children(it->path() / "children");
    for (pid_t child = 0; children >> child;)
      if (child == process) return static_cast<pid_t>(std::stol(it->path().filename().string()));
  }
  return 0;
}

}  // namespace

std::unique_ptr<Claim> enter_function(const fs::path& cache) {
  return claim_in(cache, name_of(::getpid(), ::gettid()));
}

bool is_inside_function(const fs::path& cache, pid_t thread) {
  pid_t process = ::getpid();
  while (process > 0) {
    if (is_claimed_in(cache, name_of(process, thread))) return true;
    const pid_t parent = parent_of(process);
    thread = parent > 0 ? thread_that_started(process, parent) : 0;
    process = parent;
  }
  return false;
}

}  // namespace salbench
