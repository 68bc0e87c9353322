// SPDX-License-Identifier: GPL-3.0-or-later
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string_view>
#include <system_error>

#include <fcntl.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "io/refusal.h"
#include "pipeline/commands/cli.h"

namespace {

// Opens those that whoever starts the program has closed, so that no file of it gets their number and is
// written into: an opening takes the lowest number that is free. Messages may get lost; results may not, so
// that standard output is opened for reading and does not swallow them.
void open_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(stream, F_GETFD) < 0 && errno == EBADF)
      static_cast<void>(::open("/dev/null", stream == STDERR_FILENO ? O_WRONLY : O_RDONLY));
}

// TBB starts threads where nobody can catch what it throws.
[[noreturn]] void end_for_lack_of_threads() {
  try {
    if (const auto thrown = std::current_exception()) std::rethrow_exception(thrown);
  } catch (const std::exception& error) {
    if (std::string_view(error.what()).starts_with("pthread_create")) {
      const auto refusal = std::make_error_code(std::errc::resource_unavailable_try_again);
      std::fprintf(stderr, "error: %s\n", salbench::refusal_text(std::system_error(refusal)).c_str());
      std::_Exit(salbench::kUnusableStorage);
    }
    std::fprintf(stderr, "error: a defect of salbench, please report it: %s\n", error.what());
  } catch (...) {
  }
  std::abort();
}

}  // namespace

int main(int argc, char** argv) {
  open_standard_streams();
  std::set_terminate(end_for_lack_of_threads);
  spdlog::set_default_logger(spdlog::stderr_color_mt("salbench"));
  spdlog::set_pattern("%^%l%$: %v");
  std::signal(SIGXFSZ, SIG_IGN);  // a limit on file sizes then fails the write, as a full disk does
  return salbench::run_program(argc, argv);
}
