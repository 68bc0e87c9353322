// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/machine.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <sstream>

#include <fmt/format.h>
#include <sched.h>
#include <sys/utsname.h>
#include <unistd.h>

namespace salbench {
namespace {

namespace fs = std::filesystem;

// Files of the system have no size that could be asked for first, as read_file does.
std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

// 0 for "max", for a text that is no number, and for the numbers that stand for no limit.
std::uint64_t limit_in(const fs::path& path) {
  constexpr double kNoLimit = 1e18;  // version 1 has the largest number of pages
  double value = 0;
  std::istringstream(text_of(path)) >> value;
  return value > 0 && value < kNoLimit ? static_cast<std::uint64_t>(value) : 0;
}

double ratio(double quota, double period) { return quota > 0 && period > 0 ? quota / period : 0; }

// "150000 100000", or "max 100000".
double cores_in(const fs::path& path) {
  double quota = 0, period = 0;
  std::istringstream(text_of(path)) >> quota >> period;
  return ratio(quota, period);
}

template <class T>
void lower(T& limit, T other) {
  if (other > 0) limit = limit > 0 ? std::min(limit, other) : other;
}

// Calls `visit` for the group's folder and those above it, up to the mounted one. In a container the path may
// be that on its host, which is not there: the mounted one is the container's.
template <class Visit>
void visit_groups(const fs::path& mounted, fs::path group, const Visit& visit) {
  for (group = group.relative_path(); !group.empty(); group = group.parent_path()) visit(mounted / group);
  visit(mounted);
}

std::string value_of(const std::string& text, std::string_view key) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with(key)) {
      line.erase(0, key.size());
      std::erase(line, '"');
      return line;
    }
  return {};
}

std::string system_name() {
  utsname name{};
  ::uname(&name);
  const std::string distribution = value_of(text_of("/etc/os-release"), "PRETTY_NAME=");
  return fmt::format("{}{}{} {}, {}", distribution, distribution.empty() ? "" : ", ", name.sysname,
                     name.release, name.machine);
}

}  // namespace

GroupLimits group_limits(std::string_view self, const fs::path& root) {
  GroupLimits limits;
  std::istringstream lines{std::string(self)};
  for (std::string line; std::getline(lines, line);) {  // "0::/a/b", or "4:cpu,cpuacct:/a/b"
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
    const fs::path group = line.substr(second + 1);
    const auto has = [&](std::string_view name) { return controllers.find(name) != std::string::npos; };
    if (controllers == ",,")
      visit_groups(root, group, [&](const fs::path& folder) {
        lower(limits.cores, cores_in(folder / "cpu.max"));
        lower(limits.memory_bytes, limit_in(folder / "memory.max"));
      });
    if (has(",cpu,"))
      visit_groups(root / "cpu", group, [&](const fs::path& folder) {
        lower(limits.cores, ratio(static_cast<double>(limit_in(folder / "cpu.cfs_quota_us")),
                                  static_cast<double>(limit_in(folder / "cpu.cfs_period_us"))));
      });
    if (has(",memory,"))
      visit_groups(root / "memory", group, [&](const fs::path& folder) {
        lower(limits.memory_bytes, limit_in(folder / "memory.limit_in_bytes"));
      });
  }
  return limits;
}

Cores cores() {
  Cores found{static_cast<int>(::sysconf(_SC_NPROCESSORS_ONLN)), 0};
  cpu_set_t set;
  found.allowed = ::sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : found.online;
  return found;
}

Memory memory_of(std::string_view meminfo) {
  const auto bytes = [text = std::string(meminfo)](std::string_view key) {
    std::uint64_t kibibytes = 0;
    std::istringstream(value_of(text, key)) >> kibibytes;
    return kibibytes * 1024;
  };
  return {bytes("MemTotal:"), bytes("MemAvailable:")};
}

Machine this_machine() {
  return {system_name(), cores(), memory_of(text_of("/proc/meminfo")),
          group_limits(text_of("/proc/self/cgroup"), "/sys/fs/cgroup")};
}

}  // namespace salbench
