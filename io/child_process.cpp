// SPDX-License-Identifier: GPL-3.0-or-later
// The child sends through a pipe, which the program reads to its end before it reaps the child: a pipe that
// is full would stop it.
#include "io/child_process.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <fstream>
#include <mutex>
#include <new>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include "io/descriptor.h"
#include "io/file.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

constexpr int kFailed = 1, kOutOfMemory = 3;  // exit status of the child
constexpr rlim_t kGrace = 5;                  // seconds from SIGXCPU, which tells why, to SIGKILL

[[noreturn]] void fail_for_lack(const char* of) {
  throw StorageError(fmt::format("no {} to read a file in: {}", of, system_reason(errno)));
}

// Bytes that the program has reserved.
rlim_t present_memory() {
  rlim_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE));
}

// --- in the child -----------------------------------------------------------------------------------------

void send_all(int to, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(to, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) ::_exit(kFailed);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

// The child ends with the program, and not before it: a signal to both must not look like a crash.
void follow(pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(kFailed);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_IGN);
  std::signal(SIGXCPU, SIG_DFL);
}

void limit(int resource, rlim_t soft, rlim_t hard) {
  const rlimit both{soft, hard};
  ::setrlimit(resource, &both);
}

[[noreturn]] void run_and_exit(const ChildLimits& limits, rlim_t memory, int to,
                               const std::function<void(const Send&)>& function) {
  const auto seconds = static_cast<rlim_t>(limits.processor_time.count());
  limit(RLIMIT_CPU, seconds, seconds + kGrace);
  if (limits.memory) limit(RLIMIT_AS, memory + *limits.memory, memory + *limits.memory);
  limit(RLIMIT_CORE, 0, 0);
  try {
    function([to](std::span<const std::byte> bytes) { send_all(to, bytes); });
  } catch (const std::bad_alloc&) {
    ::_exit(kOutOfMemory);
  } catch (...) {
    ::_exit(kFailed);
  }
  ::_exit(0);  // what the program registered for its exit is not the child's to run
}

// --- in the program ---------------------------------------------------------------------------------------

std::string read_to_end(int from) {
  std::string all;
  std::array<char, 65536> part{};
  for (;;) {
    const ssize_t got = ::read(from, part.data(), part.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return all;
    all.append(part.data(), static_cast<std::size_t>(got));
  }
}

// Reaps its child if reading what it sends throws: the child cannot be left, nor waited for.
class Child {
 public:
  explicit Child(pid_t pid) : pid_(pid) {}
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    wait();
  }
  int wait() {
    int status = 0;
    while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
    return status;
  }

 private:
  pid_t pid_;
};

std::string failure_of(int status, const ChildLimits& limits) {
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU)
    return fmt::format("took more than {} s of processor time", limits.processor_time.count());
  if (WIFSIGNALED(status)) {
    const char* name = ::sigdescr_np(WTERMSIG(status));
    return fmt::format("crashed (signal {}: {})", WTERMSIG(status), name == nullptr ? "unknown" : name);
  }
  if (WEXITSTATUS(status) == kOutOfMemory)
    return limits.memory ? fmt::format("took more than {} MiB of memory", *limits.memory >> 20U)
                         : "ran out of memory";
  return WEXITSTATUS(status) == 0 ? "" : fmt::format("ended with status {}", WEXITSTATUS(status));
}

}  // namespace

ChildResult run_in_child(const ChildLimits& limits, const std::function<void(const Send&)>& function) {
  // Else a child inherits the writing end of another's pipe, and the other's result waits for both.
  static std::mutex starting;
  std::unique_lock lock(starting);
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) fail_for_lack("pipe");
  const Descriptor from(ends[0]);
  Descriptor to(ends[1]);
  const rlim_t memory = present_memory();
  const pid_t program = ::getpid();
  const pid_t pid = ::fork();
  if (pid < 0) fail_for_lack("process");
  if (pid == 0) {
    follow(program);
    run_and_exit(limits, memory, to.get(), function);
  }
  Child child(pid);
  to.close();
  lock.unlock();
  ChildResult result{.sent = read_to_end(from.get()), .failure = {}};
  result.failure = failure_of(child.wait(), limits);
  return result;
}

}  // namespace salbench
