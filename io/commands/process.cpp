// SPDX-License-Identifier: GPL-3.0-or-later
// Output of commands, their timeouts and their answers. shell.h has their processes.
#include "io/commands/process.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/commands/shell.h"
#include "io/descriptor.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kGrace(2);  // from one way to end a command to the next, harder one

struct Pipe {
  Pipe() {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) fail_for_lack("pipe");
    reading = Descriptor(ends[0]);
    writing = Descriptor(ends[1]);
  }
  Descriptor reading{-1}, writing{-1};
};

void never_wait_for(const Descriptor& file) { ::fcntl(file.get(), F_SETFL, O_NONBLOCK); }

// --- what it prints ---------------------------------------------------------------------------------------

constexpr std::size_t kKept = 4096, kKeptLines = 20;  // the end of what a command prints, of each pipe

// Finds a line in text that comes in pieces, whatever else it holds.
class LineFinder {
 public:
  bool find(std::string_view piece, std::string_view line) {  // whether the line has ended in this piece
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

 private:
  std::string current_;
};

// The last lines but those that are `answer`, as a terminal can show them.
std::vector<std::string> lines_at_the_end(std::string_view output, std::string_view answer) {
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

// At most so much at a time: a flood must not keep the wait from the clock.
template <class Each>
void read_from(Pipe& pipe, std::string& kept, const Each& each) {
  std::array<char, 1U << 16U> buffer;
  for (int i = 0; i < 16 && pipe.reading.get() >= 0; ++i) {
    const ssize_t got = ::read(pipe.reading.get(), buffer.data(), buffer.size());
    if (got == 0) pipe.reading.close();
    if (got <= 0) return;
    const std::string_view piece(buffer.data(), static_cast<std::size_t>(got));
    each(piece);
    kept.append(piece);
    if (kept.size() > kKept) kept.erase(0, kept.size() - kKept);
  }
}

// From now; decades at most, because longer ones overflow the clock.
Clock::time_point deadline_after(std::chrono::duration<double> timeout) {
  constexpr std::chrono::duration<double> kLongest(1e9);
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(std::min(timeout, kLongest));
}

enum class Event : std::uint8_t { ended, answered, late };

// A command at work. When the object is gone, so are all processes of its session.
class RunningCommand {
 public:
  // One that serves reads lines, and its answers are told from its errors.
  RunningCommand(const std::string& command, const fs::path& folder, bool serves)
      : answers_(serves ? std::optional<Pipe>(std::in_place) : std::nullopt),
        lines_(serves ? std::optional<Pipe>(std::in_place) : std::nullopt),
        shell_(command, folder, lines_ ? lines_->reading.get() : -1,
               answers_ ? answers_->writing.get() : output_.writing.get(), output_.writing.get()) {
    output_.writing.close();
    never_wait_for(output_.reading);
    if (!serves) return;
    answers_->writing.close();
    never_wait_for(answers_->reading);
    // The reading end of its input stays open here too, so that a line written after it has ended raises no
    // SIGPIPE.
    never_wait_for(lines_->writing);
  }

  // False if it has left so many lines unread that there is no room. What it printed before is forgotten.
  bool tell(const std::string& line) {
    kept_output_.clear();
    kept_answers_.clear();
    return ::write(lines_->writing.get(), line.data(), line.size()) == static_cast<ssize_t>(line.size());
  }
  std::size_t unread() const {  // bytes of what it was told
    int bytes = 0;
    ::ioctl(lines_->reading.get(), FIONREAD, &bytes);
    return static_cast<std::size_t>(bytes);
  }
  void tell_no_more() { lines_->writing.close(); }

  bool has_ended() { return shell_.end().has_value(); }

  // Waits until it has ended, or the answer is printed as a line, if it is waited for, and takes in what is
  // printed meanwhile. Late at the deadline, or, if the flag counts, when the program is asked to end.
  Event wait(Clock::time_point deadline, bool until_asked_to_end, std::string_view answer = {}) {
    if (!answer.empty()) answer_ = answer;
    while (true) {
      const bool over = has_ended();
      if (take_in(answer)) return Event::answered;
      if (over) return Event::ended;
      if (Clock::now() >= deadline || (until_asked_to_end && commands_are_ended())) return Event::late;
      wait_for_event(deadline, until_asked_to_end);
    }
  }

  void terminate() {  // and a little time
    shell_.terminate();
    wait(Clock::now() + kGrace, false);
  }

  // The last lines that it printed, as one line of text; of one that serves, those beside its answers, and
  // then those of its standard error.
  std::string printed() const {
    std::vector<std::string> lines = lines_at_the_end(kept_answers_, answer_);
    const std::vector<std::string> errors = lines_at_the_end(kept_output_, {});
    lines.insert(lines.end(), errors.begin(), errors.end());
    return fmt::format("{}", fmt::join(lines, " | "));
  }
  std::string said() const { return said_of(printed()); }

  // After it has ended: why it did not succeed, empty if it did; and 128 + the signal that killed it.
  std::string failure() {
    const int status = shell_.end().value();
    if (WIFSIGNALED(status)) return fmt::format("the command was killed by signal {}", WTERMSIG(status));
    return WEXITSTATUS(status) == 0 ? ""
                                    : fmt::format("the command ended with status {}", WEXITSTATUS(status));
  }
  int status() {
    const int status = shell_.end().value();
    return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  }

 private:
  void wait_for_event(Clock::time_point deadline, bool until_asked_to_end) {
    constexpr std::chrono::milliseconds kLongest = std::chrono::hours(1);
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
    std::array<pollfd, 4> events = {{{shell_.descriptor(), POLLIN, 0},
                                     {output_.reading.get(), POLLIN, 0},
                                     {answers_ ? answers_->reading.get() : -1, POLLIN, 0},
                                     {until_asked_to_end ? ending_descriptor() : -1, POLLIN, 0}}};
    ::poll(events.data(), events.size(),
           static_cast<int>(std::clamp(left, std::chrono::milliseconds(0), kLongest).count()));
  }

  // True if the answer was in it. Answers come first: what was said on standard error before one is then
  // there.
  bool take_in(std::string_view answer) {
    bool answered = false;
    if (answers_)
      read_from(*answers_, kept_answers_,
                [&](std::string_view piece) { answered |= finder_.find(piece, answer); });
    read_from(output_, kept_output_, [](std::string_view) {});
    return answered;
  }

  Pipe output_;                          // what it prints; of one that serves, its standard error
  std::optional<Pipe> answers_, lines_;  // standard output and input of one that serves
  Shell shell_;
  LineFinder finder_;
  // The ends of what it prints: two, because nobody knows in which order it wrote into two pipes.
  std::string kept_output_, kept_answers_;
  std::string answer_;  // the last one that was waited for
};

// One line of text for a command that was not done in time.
std::string too_late(std::chrono::duration<double> timeout, const RunningCommand& command) {
  return fmt::format("the command took longer than its timeout of {} s, and was ended; {}", timeout.count(),
                     command.said());
}

void stop_if_ended() {
  if (commands_are_ended()) throw Interrupted("the program ends");
}

}  // namespace

CommandEnd try_command(const std::string& command, const fs::path& folder,
                       std::chrono::duration<double> timeout) {
  stop_if_ended();
  const auto deadline = deadline_after(timeout);
  RunningCommand running(command, folder, false);
  const bool in_time = running.wait(deadline, true) == Event::ended;
  if (!in_time) running.terminate();
  stop_if_ended();
  if (!in_time) throw TookTooLong(too_late(timeout, running));
  return {running.status(), running.failure(), running.printed()};
}

void run_command(const std::string& command, const fs::path& folder, std::chrono::duration<double> timeout) {
  const CommandEnd end = try_command(command, folder, timeout);
  if (!end.reason.empty()) throw InputError(fmt::format("{}; {}", end.reason, said_of(end.printed)));
}

std::string said_of(const std::string& printed) {
  return printed.empty() ? "it printed nothing" : "its last lines: " + printed;
}

// --- one that serves --------------------------------------------------------------------------------------

class ServingCommand::Running {
 public:
  Running(const std::string& command, const fs::path& folder) : process(command, folder, true) {}
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;
  ~Running() { end(!busy); }

  // It has time to come to the end of its lines, if it is not in the middle of one.
  void end(bool at_leisure) {
    if (std::exchange(ended_, true)) return;
    if (at_leisure && !commands_are_ended()) {
      process.tell_no_more();
      process.wait(Clock::now() + kGrace, true);
    }
    process.terminate();
  }

  RunningCommand process;
  bool busy = false;  // with a line
  bool has_answered = false;

 private:
  bool ended_ = false;
};

ServingCommand::ServingCommand(const std::string& command, const fs::path& folder) {
  stop_if_ended();
  running_ = std::make_unique<Running>(command, folder);
}

ServingCommand::~ServingCommand() = default;

bool ServingCommand::has_ended() { return running_->process.has_ended(); }

bool ServingCommand::has_answered() const { return running_->has_answered; }

std::string ServingCommand::failure() { return running_->process.failure(); }

std::string ServingCommand::last_lines() const { return running_->process.said(); }

bool ServingCommand::ask(const std::string& line, const std::string& answer,
                         std::chrono::duration<double> timeout) {
  const auto deadline = deadline_after(timeout);
  RunningCommand& process = running_->process;
  running_->busy = true;
  if (!process.tell(line + "\n")) throw InputError("the command does not read its standard input");
  const Event event = process.wait(deadline, true, answer);
  stop_if_ended();
  if (event == Event::late) {
    running_->end(false);
    throw TookTooLong(too_late(timeout, process));
  }
  running_->busy = false;
  if (event == Event::answered) return running_->has_answered = true;
  const std::string failure = process.failure();
  const bool unread = process.unread() == line.size() + 1;
  if (failure.empty() || (running_->has_answered && unread)) return false;
  const std::string what = fmt::format("{}; {}", failure, process.said());
  constexpr std::array kFromOutside = {SIGKILL, SIGTERM, SIGINT, SIGHUP, SIGQUIT};
  if (std::ranges::find(kFromOutside, process.status() - 128) != kFromOutside.end())
    throw EndedFromOutside(what);
  throw InputError(what);
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
