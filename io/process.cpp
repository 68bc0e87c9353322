// SPDX-License-Identifier: GPL-3.0-or-later
// The shell leads a process group, and whatever ends the command ends the group: its exit, the timeout, a
// signal to the program. The leader is reaped last, so that its number cannot become another group's while
// signals are sent to it. A process that leaves the group (setsid) is out of reach.
#include "io/process.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/descriptor.h"
#include "io/file.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kKeptOutput = 4096, kKeptLines = 20;     // the end of what a command prints
constexpr std::chrono::seconds kGrace(2);                      // from SIGTERM to SIGKILL
constexpr std::chrono::duration<double> kLongestTimeout(1e9);  // decades; ten times that overflow the clock
constexpr std::chrono::milliseconds kLook(100);  // how often a wait looks at the clock and the flag

// Globals, since a signal handler has nothing else. A command without a slot is ended by the wait for it.
std::atomic<bool> ending = false;
std::array<std::atomic<pid_t>, 256> groups = {};
static_assert(std::atomic<pid_t>::is_always_lock_free);

class Registered {
 public:
  explicit Registered(pid_t group) {
    for (std::atomic<pid_t>& slot : groups)
      if (pid_t none = 0; slot.compare_exchange_strong(none, group)) {
        slot_ = &slot;
        return;
      }
  }
  Registered(const Registered&) = delete;
  Registered& operator=(const Registered&) = delete;
  ~Registered() {
    if (slot_ != nullptr) *slot_ = 0;
  }

 private:
  std::atomic<pid_t>* slot_ = nullptr;
};

[[noreturn]] void fail_for_lack(const char* of) {
  throw StorageError(fmt::format("no {} to run a command: {}", of, system_reason(errno)));
}

// Only calls that are safe after a fork in a program with threads.
[[noreturn]] void become(const char* command, const char* folder, int output, pid_t parent) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // even if the program is killed
  if (::getppid() != parent) ::_exit(127);
  for (const int signal : {SIGINT, SIGTERM, SIGPIPE, SIGHUP, SIGQUIT}) std::signal(signal, SIG_DFL);
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  const int nothing = ::open("/dev/null", O_RDONLY);
  if (nothing < 0 || ::dup2(nothing, 0) < 0 || ::dup2(output, 1) < 0 || ::dup2(output, 2) < 0 ||
      ::chdir(folder) != 0)
    ::_exit(127);
  if (nothing > 2) ::close(nothing);
  ::execl("/bin/sh", "sh", "-c", command, nullptr);
  ::_exit(127);
}

// The last lines as one line of text that a terminal can show.
std::string last_lines(std::string_view output) {
  std::vector<std::string> lines(1);
  for (const char c : output) {
    if (c == '\n' || c == '\r') {
      if (!lines.back().empty()) lines.emplace_back();
    } else {
      const auto byte = static_cast<unsigned char>(c);
      lines.back() += c == '\t' ? ' ' : byte < ' ' || byte >= 0x7f ? '?' : c;
    }
  }
  if (lines.back().empty()) lines.pop_back();
  if (lines.empty()) return "it printed nothing";
  const auto first = lines.end() - static_cast<long>(std::min(lines.size(), kKeptLines));
  return fmt::format("its last lines: {}", fmt::join(first, lines.end(), " | "));
}

class Command {
 public:
  Command(const std::string& command, const fs::path& folder) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) fail_for_lack("pipe");
    output_ = ends[0];
    const Descriptor write_end(ends[1]);
    ::fcntl(output_, F_SETFL, O_NONBLOCK);
    const pid_t parent = ::getpid();
    group_ = ::fork();
    if (group_ == 0) become(command.c_str(), folder.c_str(), write_end.get(), parent);
    if (group_ < 0) {
      ::close(output_);
      fail_for_lack("process");
    }
    ::setpgid(group_, group_);  // whichever of the two is first
  }
  Command(const Command&) = delete;
  Command& operator=(const Command&) = delete;
  ~Command() {
    send(SIGKILL);
    while (::waitpid(group_, nullptr, 0) < 0 && errno == EINTR) {
    }
    ::close(output_);
  }

  pid_t group() const { return group_; }
  void send(int signal) const { ::kill(-group_, signal); }

  // Waits until the shell has ended, and takes in what is printed meanwhile. False at the deadline, or, if
  // the flag counts, when the program is asked to end.
  bool wait(Clock::time_point deadline, bool until_asked_to_end) {
    while (!has_ended()) {
      if (Clock::now() >= deadline || (until_asked_to_end && ending)) return false;
      pollfd printed{output_, POLLIN, 0};
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now());
      const auto next = std::clamp(left, std::chrono::milliseconds(1), look_);
      ::poll(closed_ ? nullptr : &printed, closed_ ? 0 : 1, static_cast<int>(next.count()));
      look_ = std::min(2 * look_, kLook);  // quick commands are not waited for longer than they take
      take_in();
    }
    send(SIGKILL);  // what it left in the background
    take_in();
    return true;
  }

  std::string said() const { return last_lines(kept_); }
  // Why it did not succeed; empty if it did. After wait.
  std::string failure() const {
    if (info_.si_code != CLD_EXITED)
      return fmt::format("the command was killed by signal {}", info_.si_status);
    return info_.si_status == 0 ? "" : fmt::format("the command ended with status {}", info_.si_status);
  }

 private:
  bool has_ended() {
    info_ = {};
    return ::waitid(P_PID, static_cast<id_t>(group_), &info_, WEXITED | WNOHANG | WNOWAIT) == 0 &&
           info_.si_pid == group_;
  }

  // At most so much at a time: a flood must not keep the wait from the clock.
  void take_in() {
    std::array<char, 1U << 16U> buffer;
    for (int i = 0; i < 16; ++i) {
      const ssize_t got = ::read(output_, buffer.data(), buffer.size());
      if (got == 0) closed_ = true;
      if (got <= 0) return;
      kept_.append(buffer.data(), static_cast<std::size_t>(got));
      if (kept_.size() > kKeptOutput) kept_.erase(0, kept_.size() - kKeptOutput);
    }
  }

  pid_t group_ = -1;
  int output_ = -1;
  bool closed_ = false;
  std::chrono::milliseconds look_{2};
  std::string kept_;
  siginfo_t info_ = {};
};

}  // namespace

ScratchFolder::ScratchFolder() {
  std::error_code error;
  const fs::path root = fs::temp_directory_path(error);
  std::string name = ((error ? fs::path("/tmp") : root) / "salbench-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr)
    throw StorageError(fmt::format("{}: the folder cannot be created: {}; set TMPDIR to another", name,
                                   system_reason(errno)));
  path_ = name;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

void run_command(const std::string& command, const fs::path& folder, std::chrono::duration<double> timeout) {
  if (ending) throw CommandInterrupted("the program ends");
  const auto deadline =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(std::min(timeout, kLongestTimeout));
  Command running(command, folder);
  const Registered registered(running.group());
  const bool in_time = running.wait(deadline, true);
  if (!in_time) {
    running.send(SIGTERM);
    running.wait(Clock::now() + kGrace, false);
  }
  if (ending) throw CommandInterrupted("the program ends");
  if (!in_time)
    throw InputError(fmt::format("the command took longer than its timeout of {} s, and was ended; {}",
                                 timeout.count(), running.said()));
  if (const std::string failure = running.failure(); !failure.empty())
    throw InputError(fmt::format("{}; {}", failure, running.said()));
}

void end_commands(int signal) {
  ending = true;
  for (const std::atomic<pid_t>& slot : groups)
    if (const pid_t group = slot; group > 0) ::kill(-group, signal);
}

std::string shell_quoted(const std::string& text) {
  constexpr std::string_view kPlain =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789/._-+=:,@%";
  if (!text.empty() && text.find_first_not_of(kPlain) == std::string::npos) return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace salbench
