// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/process.h"

#include <fmt/format.h>

#include "io/running_command.h"
#include "stages/core/errors.h"

namespace salbench {

namespace fs = std::filesystem;
using Event = RunningCommand::Event;

CommandEnd try_command(const std::string& command, const fs::path& folder,
                       std::chrono::duration<double> timeout) {
  if (commands_are_ended()) throw Interrupted("the program ends");
  const auto deadline = deadline_after(timeout);
  RunningCommand running(command, folder, RunningCommand::Serves::no);
  const bool in_time = running.wait(deadline, true) == Event::ended;
  if (!in_time) running.terminate();
  if (commands_are_ended()) throw Interrupted("the program ends");
  if (!in_time) throw InputError(too_late(timeout, running));
  return {running.status(), running.failure(), running.printed()};
}

void run_command(const std::string& command, const fs::path& folder, std::chrono::duration<double> timeout) {
  const CommandEnd end = try_command(command, folder, timeout);
  if (!end.reason.empty()) throw InputError(fmt::format("{}; {}", end.reason, said_of(end.printed)));
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
