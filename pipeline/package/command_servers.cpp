// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/package/command_servers.h"

#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "io/commands/process.h"
#include "io/commands/scratch_folder.h"
#include "stages/core/errors.h"

namespace salbench {

struct CommandServers::Server {
  Server(const std::string& command, const std::function<void(const std::filesystem::path&)>& prepare)
      : process((prepare(folder.path()), command), folder.path()) {}

  ScratchFolder folder;  // outlives the process
  ServingCommand process;
};

CommandServers::CommandServers(std::string name, std::string command,
                               std::function<void(const std::filesystem::path&)> prepare)
    : name_(std::move(name)), command_(std::move(command)), prepare_(std::move(prepare)) {}

CommandServers::~CommandServers() = default;

std::unique_ptr<CommandServers::Server> CommandServers::idle_or_new() {
  while (true) {
    std::unique_ptr<Server> server;
    {
      const std::lock_guard lock(mutex_);
      if (idle_.empty()) break;
      server = std::move(idle_.back());
      idle_.pop_back();
    }
    if (!server->process.has_ended()) return server;
    warn_of_end(*server);
  }
  return std::make_unique<Server>(command_, prepare_);
}

void CommandServers::warn_of_end(Server& server) {
  if (commands_are_ended()) return;  // by us
  const std::string failure = server.process.failure();
  const std::lock_guard lock(mutex_);
  if (failure.empty() || std::exchange(warned_, true)) return;
  spdlog::warn("{}: {} after an answer, which counts; the next shape gets a new process; {}", name_, failure,
               server.process.last_lines());
}

std::string CommandServers::ask(const std::string& line, const std::string& answer,
                                std::chrono::duration<double> timeout) {
  while (true) {
    std::unique_ptr<Server> server = idle_or_new();
    if (server->process.ask(line, answer, timeout)) {
      std::string said = server->process.last_lines();
      const std::lock_guard lock(mutex_);
      idle_.push_back(std::move(server));
      return said;
    }
    // One that ends after some shapes has had enough of them: this shape is the next one's first.
    if (!server->process.has_answered())
      throw InputError(
          fmt::format("the command ended without an answer; when it is done with a line of {{list}} it must "
                      "print the second file of that line; {}",
                      server->process.last_lines()));
    warn_of_end(*server);
  }
}

}  // namespace salbench
