// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/commands/shell.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdint>
#include <memory>
#include <mutex>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/commands/process.h"
#include "io/commands/session.h"
#include "io/file.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

// Globals, since a signal handler has nothing else. Whoever polls the event sees it until commands are
// allowed again.
std::atomic<bool> asked_to_end = false;
std::atomic<int> ending = -1, guarded = -1;  // -1: none; the guard's socket
static_assert(std::atomic<int>::is_always_lock_free);

class Guard {
 public:
  Guard() {
    if (ending < 0) ending = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (ending < 0) fail_for_lack("event");
    int ends[2];
    if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) fail_for_lack("socket");
    own_ = Descriptor(ends[0]);
    const Descriptor others(ends[1]);
    sigset_t all, before;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_SETMASK, &all, &before);  // the program's handlers are not the guard's
    process_ = ::fork();
    if (process_ == 0) run_guard(others.get());
    ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
    if (process_ < 0) fail_for_lack("process");
    guarded = own_.get();
  }
  Guard(const Guard&) = delete;
  Guard& operator=(const Guard&) = delete;
  ~Guard() {
    guarded = -1;
    own_.close();
    if (is_ours()) ::waitpid(process_, nullptr, 0);
  }

  bool is_ours() const { return program_ == ::getpid(); }  // not in a copy of the program
  static void tell(pid_t number) {                         // safe in a signal handler
    std::array<char, 16> text;
    const char* const end = std::to_chars(text.begin(), text.end(), number).ptr;
    if (guarded >= 0) ::send(guarded, text.data(), end - text.data(), MSG_NOSIGNAL);
  }

 private:
  pid_t program_ = ::getpid(), process_ = -1;
  Descriptor own_{-1};
};

// There is one, from the first time that it is needed to the end of the program.
const Guard& guard() {
  static std::mutex starting;
  static std::unique_ptr<Guard> one;
  const std::lock_guard lock(starting);
  if (one && !one->is_ours()) one.reset();
  if (!one) one = std::make_unique<Guard>();
  return *one;
}

// Killed in the moment of a start, the program could not tell the guard of the session. So the session does,
// by a copy of the program's end of the socket (3); the guard reads until that is closed, too.
constexpr int kCopy = 3;
constexpr char kTellAndRun[] =
    "trap '' PIPE; echo $$ 2>/dev/null >&3; trap - PIPE; exec /bin/sh -c \"$1\" sh 3>&-";

// The shell of a command, in a session of its own, with nothing of the program but its environment.
pid_t spawn_shell(const std::string& command, const fs::path& folder, int input, int output, int errors) {
  posix_spawn_file_actions_t files;
  ::posix_spawn_file_actions_init(&files);
  if (input < 0)
    ::posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  else
    ::posix_spawn_file_actions_adddup2(&files, input, STDIN_FILENO);
  ::posix_spawn_file_actions_adddup2(&files, output, STDOUT_FILENO);
  ::posix_spawn_file_actions_adddup2(&files, errors, STDERR_FILENO);
  ::posix_spawn_file_actions_adddup2(&files, guarded, kCopy);
  ::posix_spawn_file_actions_addclosefrom_np(&files, kCopy + 1);
  ::posix_spawn_file_actions_addchdir_np(&files, folder.c_str());
  posix_spawnattr_t attributes;
  ::posix_spawnattr_init(&attributes);
  sigset_t all, none;
  ::sigfillset(&all);
  ::sigemptyset(&none);
  ::posix_spawnattr_setsigdefault(&attributes, &all);
  ::posix_spawnattr_setsigmask(&attributes, &none);
  ::posix_spawnattr_setflags(&attributes,
                             POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
  std::string words[] = {"sh", "-c", kTellAndRun, "sh", command};
  char* const argv[] = {words[0].data(), words[1].data(), words[2].data(),
                        words[3].data(), words[4].data(), nullptr};
  pid_t shell = -1;
  errno = ::posix_spawn(&shell, "/bin/sh", &files, &attributes, argv, environ);
  ::posix_spawn_file_actions_destroy(&files);
  ::posix_spawnattr_destroy(&attributes);
  if (errno == E2BIG) throw InputError("the command is longer than the system allows");
  if (errno != 0) fail_for_lack("process");
  return shell;
}

}  // namespace

[[noreturn]] void fail_for_lack(const char* of) {
  throw StorageError(fmt::format("no {} to run a command: {}", of, system_reason(errno)));
}

Shell::Shell(const std::string& command, const fs::path& folder, int input, int output, int errors) {
  guard();
  // A disposition that was inherited would have the system forget how the command ended.
  if (struct sigaction now{}; ::sigaction(SIGCHLD, nullptr, &now) == 0 && now.sa_handler == SIG_IGN)
    std::signal(SIGCHLD, SIG_DFL);
  shell_ = spawn_shell(command, folder, input, output, errors);
  end_ = Descriptor(static_cast<int>(::syscall(SYS_pidfd_open, shell_, 0)));
  if (end_.get() >= 0) return;
  const int error = errno;
  finish();
  errno = error;
  fail_for_lack("descriptor");
}

Shell::~Shell() {
  if (!status_) finish();
}

void Shell::terminate() const {
  if (!status_) signal_session(shell_, SIGTERM);
}

std::optional<int> Shell::end() {
  pollfd event{end_.get(), POLLIN, 0};
  if (!status_ && ::poll(&event, 1, 0) > 0) finish();
  return status_;
}

// The number of the session is its own until the shell is reaped.
void Shell::finish() {
  kill_session(shell_);
  ::kill(shell_, SIGKILL);
  int status = SIGKILL;
  while (::waitpid(shell_, &status, 0) < 0 && errno == EINTR) {
  }
  Guard::tell(-shell_);
  status_ = status;
}

int ending_descriptor() { return ending; }

void prepare_commands() { guard(); }

void end_commands() {
  asked_to_end = true;
  const std::uint64_t once = 1;
  if (ending >= 0) static_cast<void>(::write(ending, &once, sizeof once));
  Guard::tell(kAskToEnd);
}

bool commands_are_ended() { return asked_to_end; }

void allow_commands() {
  if (std::uint64_t times = 0; ending >= 0) static_cast<void>(::read(ending, &times, sizeof times));
  asked_to_end = false;
}

}  // namespace salbench
