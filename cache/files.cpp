// A temporary file is named <host>.<pid>.<counter>.part: a later run on the same host can tell whether its
// writer is still alive. A recycled pid only postpones the removal.
#include "cache/files.h"

#include <atomic>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <optional>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSuffix = ".part";

class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  int get() const { return fd_; }
  int release() { return std::exchange(fd_, -1); }

 private:
  int fd_;
};

[[noreturn]] void fail(const fs::path& path, const char* doing) {
  throw StorageError(fmt::format("{}: {} failed: {}; free some space or choose another folder with --cache",
                                 path.string(), doing, std::strerror(errno)));
}

std::string host_name() {
  char name[256] = {};
  ::gethostname(name, sizeof name - 1);
  return name;
}

std::string scratch_name() {
  static std::atomic<std::uint64_t> counter = 0;
  return fmt::format("{}.{}.{}{}", host_name(), ::getpid(), counter++, kSuffix);
}

void write_all(int fd, std::span<const std::byte> bytes, const fs::path& path) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(path, "writing");
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

void write_synced(const fs::path& path, std::span<const std::byte> bytes) {
  Descriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (file.get() < 0) fail(path, "creating");
  write_all(file.get(), bytes, path);
  if (::fsync(file.get()) != 0) fail(path, "syncing");
  if (::close(file.release()) != 0) fail(path, "closing");
}

bool writer_is_alive(std::string_view name, std::string_view host) {
  if (!name.starts_with(host) || name.size() <= host.size() || name[host.size()] != '.' ||
      !name.ends_with(kSuffix))
    return true;  // not ours
  name.remove_prefix(host.size() + 1);
  pid_t pid = 0;
  if (std::from_chars(name.data(), name.data() + name.size(), pid).ec != std::errc() || pid <= 0) return true;
  return ::kill(pid, 0) == 0 || errno != ESRCH;
}

}  // namespace

std::optional<Bytes> read_bytes(const fs::path& path) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  struct stat status {};
  if (file.get() < 0 || ::fstat(file.get(), &status) != 0) return {};
  Bytes bytes(static_cast<std::size_t>(status.st_size));
  std::size_t filled = 0;
  while (filled < bytes.size()) {
    const ssize_t n = ::read(file.get(), bytes.data() + filled, bytes.size() - filled);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    filled += static_cast<std::size_t>(n);
  }
  bytes.resize(filled);
  return bytes;
}

void write_bytes_atomically(const fs::path& scratch, const fs::path& target,
                            std::span<const std::byte> bytes) {
  const fs::path temporary = scratch / scratch_name();
  try {
    write_synced(temporary, bytes);
    if (::rename(temporary.c_str(), target.c_str()) != 0) fail(target, "renaming");
  } catch (...) {
    ::unlink(temporary.c_str());
    throw;
  }
}

std::vector<fs::path> orphans(const fs::path& scratch) {
  const std::string host = host_name();
  std::vector<fs::path> found;
  std::error_code missing;
  for (const auto& entry : fs::directory_iterator(scratch, missing))
    if (!writer_is_alive(entry.path().filename().string(), host)) found.push_back(entry.path());
  return found;
}

}  // namespace salbench
