// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/kept_command.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <memory>
#include <mutex>
#include <string_view>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/file.h"
#include "io/process.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

// Globals, since a signal handler has nothing else. The event is written once and never read: whoever polls
// it, a keeper too, sees it from then on.
std::atomic<bool> ended = false;
std::atomic<int> ending = -1;
static_assert(std::atomic<int>::is_always_lock_free);

struct Sockets {
  explicit Sockets(int type) {
    int ends[2];
    if (::socketpair(AF_UNIX, type | SOCK_CLOEXEC, 0, ends) != 0) fail_for_lack("socket");
    own = Descriptor(ends[0]);
    others = Descriptor(ends[1]);
  }
  Descriptor own{-1}, others{-1};
};

class Launcher {
 public:
  Launcher() : requests_(SOCK_SEQPACKET) {
    if (ending = ::eventfd(0, EFD_CLOEXEC); ending < 0) fail_for_lack("event");
    sigset_t all, before;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_SETMASK, &all, &before);  // the program's handlers are not the launcher's
    process_ = ::fork();
    if (process_ == 0) run_launcher(requests_.others.get(), ending);
    ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
    if (process_ < 0) fail_for_lack("process");
    requests_.others.close();
  }
  Launcher(const Launcher&) = delete;
  Launcher& operator=(const Launcher&) = delete;
  ~Launcher() {
    requests_.own.close();
    if (is_ours()) ::waitpid(process_, nullptr, 0);
  }

  bool is_ours() const { return program_ == ::getpid(); }  // not in a copy of the program

  // Several threads may ask at the same time.
  void start(int control, const CommandFiles& files) const {
    const std::array<int, kRequestedFiles> sent = {control, files.output, files.errors, files.input};
    const std::size_t bytes = (files.input >= 0 ? sent.size() : sent.size() - 1) * sizeof(int);
    char byte = 0;
    iovec content{&byte, 1};
    alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof sent)> space{};
    msghdr message{};
    message.msg_iov = &content;
    message.msg_iovlen = 1;
    message.msg_control = space.data();
    message.msg_controllen = CMSG_SPACE(bytes);
    cmsghdr* const header = CMSG_FIRSTHDR(&message);
    header->cmsg_level = SOL_SOCKET;
    header->cmsg_type = SCM_RIGHTS;
    header->cmsg_len = CMSG_LEN(bytes);
    std::memcpy(CMSG_DATA(header), sent.data(), bytes);
    ssize_t done = 0;
    do done = ::sendmsg(requests_.own.get(), &message, MSG_NOSIGNAL);
    while (done < 0 && errno == EINTR);
    if (done < 0) fail_for_lack("process");
  }

 private:
  pid_t program_ = ::getpid();
  Sockets requests_;
  pid_t process_ = -1;
};

// There is one, from the first time that it is needed to the end of the program.
struct KeptLauncher {
  std::mutex starting;
  std::unique_ptr<Launcher> one;
};
KeptLauncher& kept() {
  static KeptLauncher launcher;
  return launcher;
}

Launcher& launcher() {
  const std::lock_guard lock(kept().starting);
  std::unique_ptr<Launcher>& one = kept().one;
  if (one && !one->is_ours()) one.reset();
  if (!one) one = std::make_unique<Launcher>();
  return *one;
}

void send_all(int socket, std::string_view text) {
  while (!text.empty()) {
    const ssize_t sent = ::send(socket, text.data(), text.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return;  // no keeper: the end of the command says so
    text.remove_prefix(static_cast<std::size_t>(sent));
  }
}

}  // namespace

void fail_for_lack(const char* of) {
  throw StorageError(fmt::format("no {} to run a command: {}", of, system_reason(errno)));
}

void prepare_commands() { launcher(); }

void end_commands() {
  ended = true;
  const std::uint64_t once = 1;
  if (ending >= 0) static_cast<void>(::write(ending, &once, sizeof once));
}

bool commands_are_ended() { return ended; }

// A keeper that is left polls the event that it was started with, and still sees that it is to end.
void allow_commands() {
  const std::lock_guard lock(kept().starting);
  if (!ended) return;
  kept().one.reset();
  if (const int told = ending.exchange(-1); told >= 0) ::close(told);
  ended = false;
}

KeptCommand::KeptCommand(const std::string& command, const std::filesystem::path& folder,
                         const CommandFiles& files) {
  Sockets control(SOCK_STREAM);
  launcher().start(control.others.get(), files);
  control.others.close();
  control_ = std::move(control.own);
  const std::array<std::size_t, 2> lengths = {folder.native().size(), command.size()};
  send_all(control_.get(), {reinterpret_cast<const char*>(lengths.data()), sizeof lengths});
  send_all(control_.get(), folder.native());
  send_all(control_.get(), command);
}

KeptCommand::~KeptCommand() {
  ::shutdown(control_.get(), SHUT_WR);
  KeptEnd ignored;
  ssize_t got = 0;
  do got = ::read(control_.get(), &ignored, sizeof ignored);
  while (got > 0 || (got < 0 && errno == EINTR));
}

void KeptCommand::terminate() { send_all(control_.get(), "t"); }

std::optional<KeptEnd> KeptCommand::end() {
  if (end_) return end_;
  KeptEnd end;
  const ssize_t got = ::recv(control_.get(), &end, sizeof end, MSG_DONTWAIT);
  if (got == sizeof end)
    end_ = end;
  else if (got >= 0 || (errno != EAGAIN && errno != EINTR))
    end_ = KeptEnd{0, SIGKILL};
  return end_;
}

int KeptCommand::ending_descriptor() { return ending; }

}  // namespace salbench
