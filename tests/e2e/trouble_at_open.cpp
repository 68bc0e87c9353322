// SPDX-License-Identifier: GPL-3.0-or-later
// Loaded into the program by LD_PRELOAD: what the system may do when a file or a folder is opened, or written
// to the disk.
//   SALBENCH_AT_OPEN="ERRNO COUNT PART"   the first COUNT (0: all) openings of a path that holds PART fail
//   SALBENCH_AT_OPEN="hold FILE PART"     the first one makes FILE and then waits for a signal
//   SALBENCH_AT_SYNC=ERRNO                no file can be brought to the disk
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdlib>
#include <sstream>
#include <string>
#include <string_view>

#include <dirent.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>

namespace {

template <class Function>
Function* real(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

using OpenFunction = int(const char*, int, ...);
using OpenAtFunction = int(int, const char*, int, ...);

// True, with errno, if this opening is to fail.
bool trouble(std::string_view path) {
  const char* what = std::getenv("SALBENCH_AT_OPEN");
  if (what == nullptr) return false;
  std::istringstream words(what);
  std::string action, detail, part;
  words >> action >> detail >> part;
  if (path.find(part) == path.npos) return false;
  static std::atomic<int> count = 0;
  if (action == "hold") {
    if (count++ == 0) {
      // Whoever sees the file sends a signal: it must not come before the wait for it.
      sigset_t all, before;
      ::sigfillset(&all);
      ::pthread_sigmask(SIG_SETMASK, &all, &before);
      ::close(real<OpenFunction>("open")(detail.c_str(), O_WRONLY | O_CREAT, 0600));
      ::sigsuspend(&before);
      ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
    }
    return false;
  }
  const int most = std::atoi(detail.c_str());
  if (most > 0 && count++ >= most) return false;
  errno = std::atoi(action.c_str());
  return true;
}

mode_t mode_of(std::va_list arguments) { return static_cast<mode_t>(va_arg(arguments, int)); }

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  if (trouble(path)) return -1;
  std::va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = (flags & O_CREAT) != 0 ? mode_of(arguments) : 0;
  va_end(arguments);
  return real<OpenFunction>("open")(path, flags, mode);
}

int openat(int folder, const char* path, int flags, ...) {
  if (trouble(path)) return -1;
  std::va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = (flags & O_CREAT) != 0 ? mode_of(arguments) : 0;
  va_end(arguments);
  return real<OpenAtFunction>("openat")(folder, path, flags, mode);
}

DIR* opendir(const char* path) { return trouble(path) ? nullptr : real<DIR*(const char*)>("opendir")(path); }

int fsync(int fd) {
  const char* error = std::getenv("SALBENCH_AT_SYNC");
  if (error == nullptr) return real<int(int)>("fsync")(fd);
  errno = std::atoi(error);
  return -1;
}

}  // extern "C"
