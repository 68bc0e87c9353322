// SPDX-License-Identifier: GPL-3.0-or-later
// Loaded into the program by LD_PRELOAD: kills or stops it at its Nth rename, at which a file appears.
//   SALBENCH_KILL_AT="N before"    the file is complete and has its temporary name
//   SALBENCH_KILL_AT="N after"     it has its final name, but rename() has not returned
//   SALBENCH_KILL_BY=SIGNAL        number of the signal
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <string_view>

#include <dlfcn.h>

extern "C" int rename(const char* from, const char* to) noexcept {
  static const auto real_rename =
      reinterpret_cast<int (*)(const char*, const char*)>(::dlsym(RTLD_NEXT, "rename"));
  static std::atomic<int> count = 0;
  const char* when = std::getenv("SALBENCH_KILL_AT");
  const bool now = when != nullptr && ++count == std::atoi(when);
  const char* by = std::getenv("SALBENCH_KILL_BY");
  const int signal = by != nullptr ? std::atoi(by) : SIGKILL;
  const bool before = now && std::string_view(when).ends_with("before");
  if (before) std::raise(signal);
  const int result = real_rename(from, to);
  if (now && !before) std::raise(signal);
  return result;
}
