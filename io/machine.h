// SPDX-License-Identifier: GPL-3.0-or-later
// The machine that the program runs on, as far as it limits a run. What a system does not tell is 0 or empty.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace salbench {

// Limits of the control group of this process and of those above it; 0: none.
struct GroupLimits {
  double cores = 0;  // processor time per time
  std::uint64_t memory_bytes = 0;
};

// Reads both versions of control groups. `self`: the text of /proc/self/cgroup; `root`: where their file
// systems are mounted.
GroupLimits group_limits(std::string_view self, const std::filesystem::path& root);

struct Cores {
  int online = 0;
  int allowed = 0;  // by the affinity of this process
};
Cores cores();

struct Memory {
  std::uint64_t total_bytes = 0, available_bytes = 0;
};
Memory memory_of(std::string_view meminfo);  // the text of /proc/meminfo

struct Machine {
  std::string system;  // "Debian GNU/Linux 12 (bookworm), Linux 6.1.0-18-amd64, x86_64"
  Cores cores;
  Memory memory;
  GroupLimits limits;
};
Machine this_machine();

}  // namespace salbench
