#include "io/text_file.h"

#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "stages/core/errors.h"

namespace salbench {
namespace {

constexpr const char* kUnfinished = ".salbench-part";

std::string reason(int error) { return std::system_category().message(error); }

class FileDescriptor {
 public:
  FileDescriptor(const char* path, int flags) : fd_(::open(path, flags | O_CLOEXEC, 0666)) {}
  FileDescriptor(const FileDescriptor&) = delete;
  FileDescriptor& operator=(const FileDescriptor&) = delete;
  ~FileDescriptor() { close(); }

  int get() const { return fd_; }
  bool close() {  // some file systems report a failed write only here
    const int fd = std::exchange(fd_, -1);
    return fd < 0 || ::close(fd) == 0;
  }

 private:
  int fd_;
};

bool write_all(int fd, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(fd, text.data(), text.size());
    if (written < 0 && errno != EINTR) return false;
    if (written > 0) text.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

// A rename is durable once its folder is. Not every file system can do this, and the file is whole without
// it.
void sync_folder_of(const std::filesystem::path& path) {
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  const FileDescriptor fd(folder.c_str(), O_RDONLY | O_DIRECTORY);
  if (fd.get() >= 0) ::fsync(fd.get());
}

}  // namespace

std::string read_file(const std::filesystem::path& path) {
  // Without O_NONBLOCK the opening of a pipe would wait for a writer.
  const FileDescriptor file(path.c_str(), O_RDONLY | O_NONBLOCK);
  struct stat status {};
  if (file.get() < 0 || ::fstat(file.get(), &status) != 0)
    throw InputError(fmt::format("{}: cannot be read: {}", path.string(), reason(errno)));
  if (S_ISDIR(status.st_mode))
    throw InputError(fmt::format("{}: is a folder, where a file is expected", path.string()));
  if (!S_ISREG(status.st_mode)) throw InputError(fmt::format("{}: is not a regular file", path.string()));

  std::string bytes(static_cast<std::size_t>(status.st_size), '\0');
  std::size_t filled = 0;
  while (filled < bytes.size()) {
    const ssize_t got = ::read(file.get(), bytes.data() + filled, bytes.size() - filled);
    if (got < 0 && errno != EINTR)
      throw InputError(fmt::format("{}: cannot be read: {}", path.string(), reason(errno)));
    if (got == 0) break;  // shortened meanwhile
    if (got > 0) filled += static_cast<std::size_t>(got);
  }
  bytes.resize(filled);
  return bytes;
}

void write_text_file(const std::filesystem::path& path, std::string_view text) {
  // Unique among the threads of all processes, so two writers of one path never share a temporary file.
  const std::string temporary = fmt::format("{}.{}{}", path.string(), ::gettid(), kUnfinished);
  const auto fail = [&](int error) {
    ::unlink(temporary.c_str());
    throw StorageError(fmt::format("{}: cannot be written: {}", path.string(), reason(error)));
  };
  FileDescriptor file(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC);
  if (file.get() < 0 || !write_all(file.get(), text) || ::fsync(file.get()) != 0 || !file.close() ||
      std::rename(temporary.c_str(), path.c_str()) != 0)
    fail(errno);
  sync_folder_of(path);
}

void remove_unfinished(const std::filesystem::path& folder) {
  std::error_code gone;
  for (const auto& entry : std::filesystem::directory_iterator(folder, gone))
    if (entry.path().extension() == kUnfinished) std::filesystem::remove(entry.path(), gone);
}

}  // namespace salbench
