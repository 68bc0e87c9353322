// SPDX-License-Identifier: GPL-3.0-or-later
// Commands that stay at work from shape to shape.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace salbench {

// As many as there are shapes asked for at the same time, each started when none is idle, and ended with the
// object.
class CommandServers {
 public:
  // The name is for messages; `prepare` fills the folder that one is about to be started in.
  CommandServers(std::string name, std::string command,
                 std::function<void(const std::filesystem::path&)> prepare);
  CommandServers(const CommandServers&) = delete;
  CommandServers& operator=(const CommandServers&) = delete;
  ~CommandServers();

  // Has one of them answer a line (ServingCommand::ask), and returns the last lines that it printed. One that
  // ended after an answer is replaced, with a warning if it did not end well. Throws InputError, after which
  // the one that was asked is ended; Interrupted; StorageError.
  std::string ask(const std::string& line, const std::string& answer, std::chrono::duration<double> timeout);

 private:
  struct Server;
  std::unique_ptr<Server> idle_or_new();
  void warn_of_end(Server& server);

  std::string name_, command_;
  std::function<void(const std::filesystem::path&)> prepare_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Server>> idle_;
  bool warned_ = false;  // once for all shapes
};

}  // namespace salbench
