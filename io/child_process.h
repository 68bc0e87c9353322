// SPDX-License-Identifier: GPL-3.0-or-later
// Runs a function in a child process, for libraries that damaged bytes can crash.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

namespace salbench {

struct ChildLimits {
  std::chrono::seconds processor_time;
  std::optional<std::uint64_t> memory = {};  // bytes beyond what the program has; empty: no limit
};

struct ChildResult {
  std::string sent;     // the bytes that the function sent, all of them if it ended well
  std::string failure;  // how it ended, such as "crashed (signal 11: Segmentation fault)"; empty: well
};

using Send = std::function<void(std::span<const std::byte>)>;

// Calls `function` in a copy of this process and waits for it. An exception that leaves it is a failure. The
// function may use malloc and stdio, which glibc keeps usable in the child of a program with threads, but no
// lock that another thread may hold. Throws StorageError if the system has no
// process or pipe left.
ChildResult run_in_child(const ChildLimits& limits, const std::function<void(const Send&)>& function);

}  // namespace salbench
