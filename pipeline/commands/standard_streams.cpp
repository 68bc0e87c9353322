// SPDX-License-Identifier: GPL-3.0-or-later
// fmt::print throws the system's error if the buffer cannot be emptied; the stream itself does not keep it.
#include "pipeline/commands/standard_streams.h"

#include <cerrno>
#include <cstdio>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "io/file.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

// A network file system says at a close what it could not store.
bool close_copy() {
  const int copy = ::dup(STDOUT_FILENO);
  return copy < 0 || ::close(copy) == 0;
}

[[noreturn]] void fail(int error) {
  throw StorageError(fmt::format("standard output: cannot be written to: {}",
                                 error == EBADF ? "it is closed" : system_reason(error)));
}

}  // namespace

void open_standard_streams() {
  // An opening takes the lowest number that is free. Messages may get lost; results may not, so that standard
  // output is opened for reading and does not swallow them.
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(stream, F_GETFD) < 0 && errno == EBADF)
      static_cast<void>(::open("/dev/null", stream == STDERR_FILENO ? O_WRONLY : O_RDONLY));
}

int print_all(const std::function<int()>& work) {
  int status = 0;
  try {
    status = work();
  } catch (const std::system_error& error) {
    if (std::ferror(stdout) == 0) throw;
    fail(error.code().value());
  }
  if (std::fflush(stdout) != 0 || !close_copy()) fail(errno);
  return status;
}

}  // namespace salbench
