// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/running_command.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/kept_command.h"
#include "io/process.h"

namespace salbench {
namespace {

constexpr std::size_t kKept = 4096, kKeptLines = 20;  // the end of what a command prints, of each pipe

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

// At most so much at a time: a flood must not keep the wait from the clock.
template <class Each>
void read_from(Pipe& pipe, std::string& kept, const Each& each) {
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

}  // namespace

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

// The reading end of its input stays open here too, so that a line written after it has ended raises no
// SIGPIPE.
RunningCommand::RunningCommand(const std::string& command, const std::filesystem::path& folder, Serves serves)
    : answers_(serves == Serves::yes ? std::optional<Pipe>(std::in_place) : std::nullopt),
      lines_(serves == Serves::yes ? std::optional<Pipe>(std::in_place) : std::nullopt),
      kept_(command, folder,
            {.output = answers_ ? answers_->writing() : output_.writing(),
             .errors = output_.writing(),
             .input = lines_ ? lines_->reading() : -1}) {
  output_.close_writing();
  ::fcntl(output_.reading(), F_SETFL, O_NONBLOCK);
  if (serves == Serves::no) return;
  answers_->close_writing();
  ::fcntl(answers_->reading(), F_SETFL, O_NONBLOCK);
  ::fcntl(lines_->writing(), F_SETFL, O_NONBLOCK);
}

bool RunningCommand::tell(const std::string& line) {
  kept_output_.clear();
  kept_answers_.clear();
  return ::write(lines_->writing(), line.data(), line.size()) == static_cast<ssize_t>(line.size());
}

std::size_t RunningCommand::unread() const {
  int bytes = 0;
  ::ioctl(lines_->reading(), FIONREAD, &bytes);
  return static_cast<std::size_t>(bytes);
}

RunningCommand::Event RunningCommand::wait(Clock::time_point deadline, bool until_asked_to_end,
                                           std::string_view answer) {
  if (!answer.empty()) answer_ = answer;
  while (true) {
    const bool ended = has_ended();
    if (take_in(answer)) return Event::answered;
    if (ended) return Event::ended;
    if (Clock::now() >= deadline || (until_asked_to_end && commands_are_ended())) return Event::late;
    wait_for_event(deadline, until_asked_to_end);
  }
}

void RunningCommand::wait_for_event(Clock::time_point deadline, bool until_asked_to_end) {
  constexpr std::chrono::milliseconds kLongest = std::chrono::hours(1);
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
  std::array<pollfd, 4> events = {{{kept_.descriptor(), POLLIN, 0},
                                   {output_.reading(), POLLIN, 0},
                                   {answers_ ? answers_->reading() : -1, POLLIN, 0},
                                   {until_asked_to_end ? KeptCommand::ending_descriptor() : -1, POLLIN, 0}}};
  ::poll(events.data(), events.size(),
         static_cast<int>(std::clamp(left, std::chrono::milliseconds(0), kLongest).count()));
}

void RunningCommand::terminate() {
  kept_.terminate();
  wait(Clock::now() + kCommandGrace, false);
}

std::string said_of(const std::string& printed) {
  return printed.empty() ? "it printed nothing" : "its last lines: " + printed;
}

std::string RunningCommand::printed() const {
  std::vector<std::string> lines = last_lines(kept_answers_, answer_);
  const std::vector<std::string> errors = last_lines(kept_output_, {});
  lines.insert(lines.end(), errors.begin(), errors.end());
  return fmt::format("{}", fmt::join(lines, " | "));
}

std::string RunningCommand::failure() {
  const auto [error, status] = kept_.end().value();
  if (errno = error; error != 0) fail_for_lack("process");
  if (WIFSIGNALED(status)) return fmt::format("the command was killed by signal {}", WTERMSIG(status));
  return WEXITSTATUS(status) == 0 ? "" : fmt::format("the command ended with status {}", WEXITSTATUS(status));
}

int RunningCommand::status() {
  const int status = kept_.end().value().status;
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

// Whether the answer was in it. Answers come first: what was said on standard error before one is then there.
bool RunningCommand::take_in(std::string_view answer) {
  bool answered = false;
  if (answers_)
    read_from(*answers_, kept_answers_,
              [&](std::string_view piece) { answered |= finder_.find(piece, answer); });
  read_from(output_, kept_output_, [](std::string_view) {});
  return answered;
}

RunningCommand::Clock::time_point deadline_after(std::chrono::duration<double> timeout) {
  constexpr std::chrono::duration<double> kLongest(1e9);
  return RunningCommand::Clock::now() +
         std::chrono::duration_cast<RunningCommand::Clock::duration>(std::min(timeout, kLongest));
}

std::string too_late(std::chrono::duration<double> timeout, const RunningCommand& command) {
  return fmt::format("the command took longer than its timeout of {} s, and was ended; {}", timeout.count(),
                     command.said());
}

}  // namespace salbench
