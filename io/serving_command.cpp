// SPDX-License-Identifier: GPL-3.0-or-later
// It dies with the program, however that ends. The kernel sends the signal for it (PR_SET_PDEATHSIG) when the
// thread that forked ends, and threads of a flow graph come and go: each serving command has a thread that
// forks it, and then waits.
#include "io/serving_command.h"

#include <cerrno>
#include <exception>
#include <optional>
#include <semaphore>
#include <system_error>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "io/process.h"
#include "io/process_group.h"
#include "stages/core/errors.h"

namespace salbench {

namespace fs = std::filesystem;
using Clock = ProcessGroup::Clock;
using Event = ProcessGroup::Event;

class ServingCommand::Running {
 public:
  Running(const std::string& command, const fs::path& folder) {
    try {
      keeper_ = std::thread([&] { keep(command, folder); });
    } catch (const std::system_error& error) {
      errno = error.code().value();
      fail_for_lack("thread");
    }
    started_.acquire();
    if (!error_) return;
    keeper_.join();
    std::rethrow_exception(error_);
  }
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;
  ~Running() {
    end(!busy);
    group_.reset();
    over_.release();
    keeper_.join();
  }

  ProcessGroup& group() { return *group_; }

  // It has time to come to the end of its lines, if it is not in the middle of one.
  void end(bool at_leisure) {
    if (std::exchange(ended_, true)) return;
    if (at_leisure && !commands_are_ended()) {
      group_->tell_no_more();
      group_->wait(Clock::now() + kCommandGrace, true);
    }
    group_->terminate();
  }

  bool busy = false;  // with a line

 private:
  // Once it has started, nothing of the constructor's is touched.
  void keep(const std::string& command, const fs::path& folder) {
    try {
      group_.emplace(command, folder, ProcessGroup::Serves::yes);
    } catch (...) {
      error_ = std::current_exception();
    }
    const bool to_wait = group_.has_value();
    started_.release();
    if (to_wait) over_.acquire();
  }

  std::optional<ProcessGroup> group_;
  std::exception_ptr error_;
  std::binary_semaphore started_{0}, over_{0};
  std::thread keeper_;
  bool ended_ = false;
};

ServingCommand::ServingCommand(const std::string& command, const fs::path& folder) {
  if (commands_are_ended()) throw CommandInterrupted("the program ends");
  running_ = std::make_unique<Running>(command, folder);
}

ServingCommand::~ServingCommand() = default;

bool ServingCommand::has_ended() { return running_->group().has_ended(); }

std::string ServingCommand::last_lines() const { return running_->group().said(); }

bool ServingCommand::ask(const std::string& line, const std::string& answer,
                         std::chrono::duration<double> timeout) {
  const auto deadline = deadline_after(timeout);
  ProcessGroup& group = running_->group();
  running_->busy = true;
  if (!group.tell(line + "\n")) throw InputError("the command does not read its standard input");
  const Event event = group.wait(deadline, true, answer);
  if (commands_are_ended()) throw CommandInterrupted("the program ends");
  if (event == Event::late) {
    running_->end(false);
    throw InputError(too_late(timeout, group));
  }
  running_->busy = false;
  if (event == Event::answered) return true;
  if (const std::string failure = group.failure(); !failure.empty())
    throw InputError(fmt::format("{}; {}", failure, group.said()));
  return false;
}

}  // namespace salbench
