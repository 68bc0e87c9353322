// SPDX-License-Identifier: GPL-3.0-or-later
// A session of their own keeps the launcher and the keepers from the signals of a terminal, and their name
// from a `killall salbench`: they would not be there to clean up.
#include "io/command_launcher.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <optional>
#include <span>
#include <string>

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/descendants.h"
#include "io/scratch_folder.h"

namespace salbench {
namespace {

using Files = std::array<int, kRequestedFiles>;  // -1: none

constexpr const char* kName = "command-keeper";  // of the process, 15 characters at most

// The launcher needs two descriptors. All others would stay open as long as it lives: ends of pipes, locks.
void keep_only(int& requests, int& ending) {
  constexpr int kRequests = 3, kEnding = 4, kOthers = 5;
  requests = ::fcntl(requests, F_DUPFD_CLOEXEC, kOthers);
  ending = ::fcntl(ending, F_DUPFD_CLOEXEC, kOthers);
  requests = ::dup3(requests, kRequests, O_CLOEXEC);
  ending = ::dup3(ending, kEnding, O_CLOEXEC);
  ::closefrom(kOthers);
  const int nothing = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) ::dup2(nothing, stream);
  ::close(nothing);
}

// Returns false at the end of the requests.
bool receive(int requests, Files& files) {
  files.fill(-1);
  char byte = 0;
  iovec content{&byte, 1};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(Files))> space{};
  msghdr message{};
  message.msg_iov = &content;
  message.msg_iovlen = 1;
  message.msg_control = space.data();
  message.msg_controllen = space.size();
  ssize_t got = 0;
  do got = ::recvmsg(requests, &message, MSG_CMSG_CLOEXEC);
  while (got < 0 && errno == EINTR);
  if (got <= 0) return false;
  const cmsghdr* header = CMSG_FIRSTHDR(&message);
  if (header != nullptr && header->cmsg_type == SCM_RIGHTS)
    std::memcpy(files.data(), CMSG_DATA(header), header->cmsg_len - CMSG_LEN(0));
  return true;
}

void report(int control, int error, int status) {
  const KeptEnd end{error, status};
  ::send(control, &end, sizeof end, MSG_NOSIGNAL);
}

// --- in a keeper ------------------------------------------------------------------------------------------

struct Request {
  std::string folder, command;
};

// The program may end before it has written all of it.
bool read_exactly(int from, void* to, std::size_t bytes) {
  for (auto* at = static_cast<char*>(to); bytes > 0;) {
    const ssize_t got = ::read(from, at, bytes);
    if (got <= 0) return false;
    at += got;
    bytes -= static_cast<std::size_t>(got);
  }
  return true;
}

std::optional<Request> read_request(int control) {
  std::array<std::size_t, 2> lengths{};
  if (!read_exactly(control, lengths.data(), sizeof lengths)) return {};
  Request request{std::string(lengths[0], '\0'), std::string(lengths[1], '\0')};
  if (!read_exactly(control, request.folder.data(), lengths[0]) ||
      !read_exactly(control, request.command.data(), lengths[1]))
    return {};
  return request;
}

[[noreturn]] void become(const Request& request, const Files& files, pid_t keeper) {
  ::setpgid(0, 0);  // `kill 0` in the command must not reach the keeper
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != keeper) ::_exit(127);
  for (int signal = 1; signal < NSIG; ++signal) std::signal(signal, SIG_DFL);
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  if ((files[kInput] >= 0 && ::dup2(files[kInput], STDIN_FILENO) < 0) ||
      ::dup2(files[kOutput], STDOUT_FILENO) < 0 || ::dup2(files[kErrors], STDERR_FILENO) < 0 ||
      ::chdir(request.folder.c_str()) != 0)
    ::_exit(127);
  ::execl("/bin/sh", "sh", "-c", request.command.c_str(), nullptr);
  ::_exit(127);
}

// Reaps the dead children; the status of the shell if it is among them.
std::optional<int> reap(pid_t shell) {
  std::optional<int> its;
  int status = 0;
  for (pid_t reaped = 0; (reaped = ::waitpid(-1, &status, WNOHANG)) > 0;)
    if (reaped == shell) its = status;
  return its;
}

void close_all(std::span<const int> files) {
  for (const int file : files)
    if (file >= 0) ::close(file);
}

// A descriptor that polls as readable after the death of a child.
int watch_children() {
  std::signal(SIGCHLD, SIG_DFL);
  sigset_t child;
  ::sigemptyset(&child);
  ::sigaddset(&child, SIGCHLD);
  ::sigprocmask(SIG_BLOCK, &child, nullptr);
  return ::signalfd(-1, &child, SFD_CLOEXEC | SFD_NONBLOCK);
}

// Returns the status of the shell, or nothing if the program wants no more of the command.
std::optional<int> wait_for_shell(pid_t shell, int children, int control, int ending) {
  std::array<pollfd, 3> watched = {{{children, POLLIN, 0}, {control, POLLIN, 0}, {ending, POLLIN, 0}}};
  while (true) {
    ::poll(watched.data(), watched.size(), -1);
    if (watched[0].revents != 0) {
      signalfd_siginfo ignored{};
      static_cast<void>(::read(children, &ignored, sizeof ignored));
      if (const auto status = reap(shell)) return status;
    }
    if (watched[1].revents != 0) {
      char order = 0;
      if (::read(control, &order, 1) <= 0) return {};
      signal_descendants(SIGTERM);
    }
    if (watched[2].revents != 0) {
      watched[2].fd = -1;  // it stays readable
      signal_descendants(SIGTERM);
    }
  }
}

void keep(const Files& files, int ending) {
  const int control = files[kControl];
  const auto request = read_request(control);
  if (!request) return;
  ::prctl(PR_SET_CHILD_SUBREAPER, 1);
  const int children = watch_children();
  const pid_t keeper = ::getpid(), shell = children < 0 ? -1 : ::fork();
  if (shell == 0) become(*request, files, keeper);
  if (shell < 0) return report(control, errno, 0);
  close_all(std::span(files).subspan(kControl + 1));
  const auto status = wait_for_shell(shell, children, control, ending);
  end_descendants();
  if (status) report(control, 0, *status);
}

// --- in the launcher --------------------------------------------------------------------------------------

void start_keeper(const Files& files, int requests, int ending) {
  const pid_t keeper = ::fork();
  if (keeper == 0) {
    ::close(requests);
    keep(files, ending);
    ::_exit(0);
  }
  if (keeper < 0) report(files[kControl], errno, 0);
  close_all(files);
}

}  // namespace

void run_launcher(int requests, int ending) try {
  ::setsid();
  ::prctl(PR_SET_NAME, kName);
  ::prctl(PR_SET_CHILD_SUBREAPER, 1);  // of a keeper that was killed
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGCHLD}) std::signal(signal, SIG_IGN);
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  keep_only(requests, ending);
  for (Files files; receive(requests, files);) start_keeper(files, requests, ending);
  end_descendants();
  remove_abandoned_scratch();
  ::_exit(0);
} catch (...) {
  ::_exit(1);
}

}  // namespace salbench
