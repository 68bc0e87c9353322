// SPDX-License-Identifier: GPL-3.0-or-later
// Whatever ends the command ends the group: its exit, the timeout, a signal to the program. The leader is
// reaped last, so that its number cannot become another group's while signals are sent to it. A process that
// leaves the group (setsid) is out of reach.
#include "io/process_group.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/file.h"
#include "io/process.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

constexpr std::size_t kKept = 4096, kKeptLines = 20;  // the end of what a command prints, of each pipe
constexpr std::chrono::milliseconds kLook(100);       // how often a wait looks at the clock and the flag

// Globals, since a signal handler has nothing else. A command without a slot is ended by the wait for it.
std::atomic<bool> ending = false;
std::array<std::atomic<pid_t>, 256> groups = {};
static_assert(std::atomic<pid_t>::is_always_lock_free);

void put_on_list(pid_t group) {
  for (std::atomic<pid_t>& slot : groups)
    if (pid_t none = 0; slot.compare_exchange_strong(none, group)) return;
}

void take_off_list(pid_t group) {
  for (std::atomic<pid_t>& slot : groups)
    if (pid_t its = group; slot.compare_exchange_strong(its, 0)) return;
}

// File descriptors of a command. Input -1: /dev/null.
struct StandardFiles {
  int input, output, errors;
};

// Only calls that are safe after a fork in a program with threads.
[[noreturn]] void become(const char* command, const char* folder, const StandardFiles& its, pid_t parent) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // even if the program is killed
  if (::getppid() != parent) ::_exit(127);
  for (const int signal : {SIGINT, SIGTERM, SIGPIPE, SIGHUP, SIGQUIT}) std::signal(signal, SIG_DFL);
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  const int input = its.input >= 0 ? its.input : ::open("/dev/null", O_RDONLY);
  if (input < 0 || ::dup2(input, 0) < 0 || ::dup2(its.output, 1) < 0 || ::dup2(its.errors, 2) < 0 ||
      ::chdir(folder) != 0)
    ::_exit(127);
  if (its.input < 0 && input > 2) ::close(input);
  ::execl("/bin/sh", "sh", "-c", command, nullptr);
  ::_exit(127);
}

// The last lines but those that are `answer`, as a terminal can show them.
std::vector<std::string> last_lines(std::string_view output, std::string_view answer) {
  std::vector<std::string> lines(1);
  for (const char c : output) {
    if (c == '\n' || c == '\r') {
      if (!lines.back().empty()) lines.emplace_back();
    } else {
      const auto byte = static_cast<unsigned char>(c);
      lines.back() += c == '\t' ? ' ' : byte < ' ' || byte >= 0x7f ? '?' : c;
    }
  }
  std::erase_if(lines, [&](const std::string& line) { return line.empty() || line == answer; });
  lines.erase(lines.begin(), lines.end() - static_cast<long>(std::min(lines.size(), kKeptLines)));
  return lines;
}

}  // namespace

void fail_for_lack(const char* of) {
  throw StorageError(fmt::format("no {} to run a command: {}", of, system_reason(errno)));
}

bool commands_are_ended() { return ending; }

void end_commands(int signal) {
  ending = true;
  for (const std::atomic<pid_t>& slot : groups)
    if (const pid_t group = slot; group > 0) ::kill(-group, signal);
}

Pipe::Pipe() {
  if (::pipe2(ends_, O_CLOEXEC) != 0) fail_for_lack("pipe");
}

Pipe::~Pipe() {
  close(kReading);
  close(kWriting);
}

void Pipe::close(End end) {
  if (ends_[end] >= 0) ::close(ends_[end]);
  ends_[end] = -1;
}

bool LineFinder::find(std::string_view piece, std::string_view line) {
  bool found = false;
  for (const char c : piece) {
    if (c == '\n' || c == '\r') {
      found |= current_ == line;
      current_.clear();
    } else if (current_.size() <= line.size()) {  // a longer one is another, however long
      current_ += c;
    }
  }
  return found;
}

ProcessGroup::ProcessGroup(const std::string& command, const std::filesystem::path& folder, Serves serves) {
  if (serves == Serves::yes) {
    lines_.emplace();
    answers_.emplace();
    ::fcntl(lines_->writing(), F_SETFL, O_NONBLOCK);
    ::fcntl(answers_->reading(), F_SETFL, O_NONBLOCK);
  }
  ::fcntl(output_.reading(), F_SETFL, O_NONBLOCK);
  const StandardFiles its{lines_ ? lines_->reading() : -1, answers_ ? answers_->writing() : output_.writing(),
                          output_.writing()};
  const pid_t parent = ::getpid();
  group_ = ::fork();
  if (group_ == 0) become(command.c_str(), folder.c_str(), its, parent);
  if (group_ < 0) fail_for_lack("process");
  ::setpgid(group_, group_);  // whichever of the two is first
  put_on_list(group_);
  output_.close_writing();
  if (answers_) answers_->close_writing();
  // The reading end of its input stays open here too, so that a line written after it has ended raises no
  // SIGPIPE.
}

ProcessGroup::~ProcessGroup() {
  take_off_list(group_);
  send(SIGKILL);
  while (::waitpid(group_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

void ProcessGroup::send(int signal) const { ::kill(-group_, signal); }

bool ProcessGroup::tell(const std::string& line) {
  kept_output_.clear();
  kept_answers_.clear();
  look_ = kFirstLook;
  return ::write(lines_->writing(), line.data(), line.size()) == static_cast<ssize_t>(line.size());
}

bool ProcessGroup::has_ended() {
  info_ = {};
  return ::waitid(P_PID, static_cast<id_t>(group_), &info_, WEXITED | WNOHANG | WNOWAIT) == 0 &&
         info_.si_pid == group_;
}

ProcessGroup::Event ProcessGroup::wait(Clock::time_point deadline, bool until_asked_to_end,
                                       std::string_view answer) {
  if (!answer.empty()) answer_ = answer;
  while (true) {
    const bool ended = has_ended();
    if (ended) send(SIGKILL);  // what it left in the background
    if (take_in(answer)) return Event::answered;
    if (ended) return Event::ended;
    if (Clock::now() >= deadline || (until_asked_to_end && ending)) return Event::late;
    wait_for_output(deadline);
  }
}

void ProcessGroup::terminate() {
  send(SIGTERM);
  wait(Clock::now() + kCommandGrace, false);
}

std::string ProcessGroup::said() const {
  std::vector<std::string> lines = last_lines(kept_answers_, answer_);
  const std::vector<std::string> errors = last_lines(kept_output_, {});
  lines.insert(lines.end(), errors.begin(), errors.end());
  return lines.empty() ? "it printed nothing" : fmt::format("its last lines: {}", fmt::join(lines, " | "));
}

std::string ProcessGroup::failure() const {
  if (info_.si_code != CLD_EXITED) return fmt::format("the command was killed by signal {}", info_.si_status);
  return info_.si_status == 0 ? "" : fmt::format("the command ended with status {}", info_.si_status);
}

void ProcessGroup::wait_for_output(Clock::time_point deadline) {
  std::array<pollfd, 2> printed{};
  nfds_t open = 0;
  for (const Pipe* pipe : {&output_, answers_ ? &*answers_ : nullptr})
    if (pipe != nullptr && pipe->reading() >= 0) printed[open++] = {pipe->reading(), POLLIN, 0};
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now());
  const auto next = std::clamp(left, std::chrono::milliseconds(1), look_);
  ::poll(printed.data(), open, static_cast<int>(next.count()));
  look_ = std::min(2 * look_, kLook);  // quick commands are not waited for longer than they take
}

// At most so much at a time: a flood must not keep the wait from the clock.
template <class Each>
void ProcessGroup::read_from(Pipe& pipe, std::string& kept, const Each& each) {
  std::array<char, 1U << 16U> buffer;
  for (int i = 0; i < 16 && pipe.reading() >= 0; ++i) {
    const ssize_t got = ::read(pipe.reading(), buffer.data(), buffer.size());
    if (got == 0) pipe.close_reading();
    if (got <= 0) return;
    const std::string_view piece(buffer.data(), static_cast<std::size_t>(got));
    each(piece);
    kept.append(piece);
    if (kept.size() > kKept) kept.erase(0, kept.size() - kKept);
  }
}

// Whether the answer was in it. Answers come first: what was said on standard error before one is then there.
bool ProcessGroup::take_in(std::string_view answer) {
  bool answered = false;
  if (answers_)
    read_from(*answers_, kept_answers_,
              [&](std::string_view piece) { answered |= finder_.find(piece, answer); });
  read_from(output_, kept_output_, [](std::string_view) {});
  return answered;
}

ProcessGroup::Clock::time_point deadline_after(std::chrono::duration<double> timeout) {
  constexpr std::chrono::duration<double> kLongest(1e9);
  return ProcessGroup::Clock::now() +
         std::chrono::duration_cast<ProcessGroup::Clock::duration>(std::min(timeout, kLongest));
}

std::string too_late(std::chrono::duration<double> timeout, const ProcessGroup& group) {
  return fmt::format("the command took longer than its timeout of {} s, and was ended; {}", timeout.count(),
                     group.said());
}

}  // namespace salbench
