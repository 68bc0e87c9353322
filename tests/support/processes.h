// SPDX-License-Identifier: GPL-3.0-or-later
// Processes of this machine, as /proc shows them.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

#include "io/descriptor.h"

namespace salbench {

// A file of a process ("cmdline", "status"); empty if the process is gone, before the reading or during it.
inline std::string process_file(std::string_view number, std::string_view name) {
  const std::string path = "/proc/" + std::string(number) + "/" + std::string(name);
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  std::string text;
  std::array<char, 4096> part;
  for (ssize_t got = 0; (got = ::read(file.get(), part.data(), part.size())) > 0;)
    text.append(part.data(), static_cast<std::size_t>(got));
  return text;
}

// Gone, or dead: a zombie that nobody has reaped yet, or one that is being reaped (X).
inline bool is_gone(std::string_view number) {
  const std::string status = process_file(number, "status");
  const auto is_in = [&](const char* state) { return status.find(state) != std::string::npos; };
  return status.empty() || is_in("State:\tZ") || is_in("State:\tX");
}

// Numbers of the processes one of whose files holds the text.
inline std::vector<std::string> processes_with(std::string_view text, std::string_view file = "cmdline") {
  std::vector<std::string> found;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    const std::string number = entry.path().filename().string();
    if (number.find_first_not_of("0123456789") != std::string::npos) continue;
    if (process_file(number, file).find(text) != std::string::npos) found.push_back(number);
  }
  return found;
}

// For ends that nobody waits for, such as those of a killed program's commands. False after five minutes,
// which is less than what tests start and leave behind lives by itself.
template <class Condition>
bool soon(const Condition& condition) {
  for (int i = 0; i < 30000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return condition();
}

}  // namespace salbench
