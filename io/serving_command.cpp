// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/serving_command.h"

#include <utility>

#include <fmt/format.h>

#include "io/process.h"
#include "io/running_command.h"
#include "stages/core/errors.h"

namespace salbench {

namespace fs = std::filesystem;
using Clock = RunningCommand::Clock;
using Event = RunningCommand::Event;

class ServingCommand::Running {
 public:
  Running(const std::string& command, const fs::path& folder)
      : process(command, folder, RunningCommand::Serves::yes) {}
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;
  ~Running() { end(!busy); }

  // It has time to come to the end of its lines, if it is not in the middle of one.
  void end(bool at_leisure) {
    if (std::exchange(ended_, true)) return;
    if (at_leisure && !commands_are_ended()) {
      process.tell_no_more();
      process.wait(Clock::now() + kCommandGrace, true);
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
  if (commands_are_ended()) throw Interrupted("the program ends");
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
  if (commands_are_ended()) throw Interrupted("the program ends");
  if (event == Event::late) {
    running_->end(false);
    throw InputError(too_late(timeout, process));
  }
  running_->busy = false;
  if (event == Event::answered) return running_->has_answered = true;
  const std::string failure = process.failure();
  const bool unread = process.unread() == line.size() + 1;
  if (failure.empty() || (running_->has_answered && unread)) return false;
  throw InputError(fmt::format("{}; {}", failure, process.said()));
}

}  // namespace salbench
