// SPDX-License-Identifier: GPL-3.0-or-later
// A writer creates its file, locks it, and checks that the name still refers to it; a clean-up locks a file
// before removing it. So neither can take the other's file. The locks belong to the open file (F_OFD_SETLK):
// they hold between threads too, and end with the last descriptor.
#include "io/file.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <map>
#include <memory>
#include <system_error>
#include <utility>

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/descriptor.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kUnfinished = ".salbench-part";

int open_file(const fs::path& path, int flags) {
  int fd = -1;
  do fd = ::open(path.c_str(), flags | O_CLOEXEC, 0666);
  while (fd < 0 && errno == EINTR);
  return fd;
}

[[noreturn]] void throw_refused(const fs::path& path, std::string_view what, int error) {
  throw StorageError(fmt::format("{}: cannot be {}: {}", path.string(), what, system_reason(error)));
}

bool lacks_resources(int error) { return error == EMFILE || error == ENFILE || error == ENOMEM; }

// Reports a user's file as unusable, unless the system lacks resources to open any file.
[[noreturn]] void fail_input(const fs::path& path, int error) {
  if (lacks_resources(error)) throw_refused(path, "read", error);
  const std::string what = fmt::format("cannot be read: {}", system_reason(error));
  constexpr std::array kIsNotThere = {ENOENT, ENOTDIR, EISDIR, ELOOP, ENAMETOOLONG};
  if (std::ranges::find(kIsNotThere, error) != kIsNotThere.end()) throw FileError(path, what);
  throw UnreadableError(path, what);
}

// Fills the buffer as far as the file reaches; returns an error number, or 0.
template <class Buffer>
int read_all(int fd, Buffer& buffer) {
  std::size_t filled = 0;
  while (filled < buffer.size()) {
    const ssize_t got = ::read(fd, buffer.data() + filled, buffer.size() - filled);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return errno;
    if (got == 0) break;  // the file was shortened in the meantime
    filled += static_cast<std::size_t>(got);
  }
  buffer.resize(filled);
  return 0;
}

// Bytes of a regular file, opened with O_NONBLOCK: opening a pipe would wait for its writer.
std::size_t check_regular(int fd, const fs::path& path) {
  struct stat status {};
  if (fd < 0 || ::fstat(fd, &status) != 0) fail_input(path, errno);
  if (S_ISDIR(status.st_mode)) throw FileError(path, "is a folder, where a file is expected");
  if (!S_ISREG(status.st_mode)) throw FileError(path, "is not a regular file");
  return static_cast<std::size_t>(status.st_size);
}

// Locks an unfinished file; returns an error number, or 0.
int lock(int fd) {
  struct flock whole {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  return ::fcntl(fd, F_OFD_SETLK, &whole) == 0 ? 0 : errno;
}

bool is_held(int error) { return error == EAGAIN || error == EACCES; }

fs::path folder_of(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : "."; }

// Makes a rename in the folder durable. Failures are ignored: not every file system supports it, and the file
// is complete anyway.
void sync_folder(const fs::path& folder) {
  const Descriptor fd(open_file(folder, O_RDONLY | O_DIRECTORY));
  if (fd.get() >= 0) ::fsync(fd.get());
}

std::int64_t nanoseconds(const timespec& time) { return time.tv_sec * 1'000'000'000LL + time.tv_nsec; }

std::string zeros(std::size_t size, const fs::path& path) try {
  return std::string(size, '\0');
} catch (const std::exception&) {  // bad_alloc, or length_error for more than max_size()
  throw UnreadableError(path, fmt::format("no memory for its {} bytes; use fewer {}, or leave it out with {}",
                                          size, as_option("threads"), as_option("items")));
}

bool is_missing(int error) { return error == ENOENT || error == ENOTDIR; }

// From the system's generator: host names and process numbers repeat between containers.
std::string random_digits() {
  std::uint64_t number = 0;
  if (::getrandom(&number, sizeof number, 0) != sizeof number)
    throw StorageError("the system gives no random number: " + system_reason(errno));
  return fmt::format("{:016x}", number);
}

}  // namespace

std::string system_reason(int error) {
  static const std::string fewer = "use fewer " + as_option("threads");
  static const std::map<int, std::string> advice = {
      {EMFILE, fewer + ", or raise the limit (ulimit -n)"},
      {ENFILE, "close other programs, or " + fewer},
      {ENOMEM, fewer + ", or close other programs"},
      {ENOSPC, "free some space, or choose another folder"},
      {EDQUOT, "free some space, or choose another folder"},
      {EFBIG, "raise the limit on the size of files (ulimit -f)"},
      {EACCES, "check its permissions"},
      {EPERM, "check its permissions"},
      {EROFS, "choose another folder"},
      {EIO, "the disk or the network file system failed; check it and run again"},
      {ESTALE, "the disk or the network file system failed; check it and run again"}};
  const auto found = advice.find(error);
  const std::string reason = std::system_category().message(error);
  return found == advice.end() ? reason : fmt::format("{}; {}", reason, found->second);
}

std::string refusal_text(const std::system_error& refusal) {
  const auto* of_file = dynamic_cast<const fs::filesystem_error*>(&refusal);
  if (of_file != nullptr)
    return fmt::format("{}: {}", of_file->path1().string(), system_reason(refusal.code().value()));
  if (refusal.code() == std::errc::resource_unavailable_try_again)
    return fmt::format(
        "the system starts no more threads: use fewer {}, or raise its limits (ulimit -u, ulimit -v)",
        as_option("threads"));
  return refusal.what();
}

// The size is checked before memory is allocated: a sparse file can have any size.
std::string read_file(const fs::path& path, std::uint64_t most) {
  const Descriptor file(open_file(path, O_RDONLY | O_NONBLOCK));
  const std::size_t size = check_regular(file.get(), path);
  if (size > most)
    throw FileError(
        path, fmt::format("{} bytes: at most {} can be read; simplify the shape, or copy the file again "
                          "if it should be smaller",
                          size, most));
  std::string bytes = zeros(size, path);
  if (const int error = read_all(file.get(), bytes); error != 0) fail_input(path, error);
  return bytes;
}

std::string read_head(const fs::path& path, std::size_t bytes) {
  const Descriptor file(open_file(path, O_RDONLY | O_NONBLOCK));
  std::string head(std::min(bytes, check_regular(file.get(), path)), '\0');
  if (const int error = read_all(file.get(), head); error != 0) fail_input(path, error);
  return head;
}

std::optional<OpenFile> OpenFile::open(const fs::path& path) {
  Descriptor file(-1);
  struct stat status {};
  // On network file systems, ESTALE means that the file was replaced: a second attempt opens the new one.
  for (bool first = true;; first = false) {
    file = Descriptor(open_file(path, O_RDONLY | O_NONBLOCK));
    if (file.get() >= 0 && ::fstat(file.get(), &status) == 0) break;
    if (is_missing(errno)) return {};
    if (errno != ESTALE || !first) throw_refused(path, "read", errno);
  }
  const bool has_bytes = S_ISREG(status.st_mode);
  return OpenFile(path, std::move(file), has_bytes ? static_cast<std::uint64_t>(status.st_size) : 0,
                  nanoseconds(status.st_ctim));
}

Bytes OpenFile::read(std::uint64_t at, std::uint64_t bytes) const {
  Bytes buffer(at < size_ ? std::min(bytes, size_ - at) : 0);
  std::size_t filled = 0;
  while (filled < buffer.size()) {
    const ssize_t got =
        ::pread(file_.get(), buffer.data() + filled, buffer.size() - filled, static_cast<off_t>(at + filled));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw_refused(path_, "read", errno);
    if (got == 0) break;  // the file was shortened in the meantime
    filled += static_cast<std::size_t>(got);
  }
  buffer.resize(filled);
  return buffer;
}

std::optional<Bytes> read_bytes(const fs::path& path) {
  const std::optional<OpenFile> file = OpenFile::open(path);
  return file ? std::optional(file->read(0, file->size())) : std::nullopt;
}

UnfinishedFile::UnfinishedFile(const fs::path& folder) {
  for (;;) {
    path_ = folder / fmt::format("{}{}", random_digits(), kUnfinished);
    Descriptor file(open_file(path_, O_RDWR | O_CREAT | O_EXCL));
    if (file.get() < 0 && errno == EEXIST) continue;
    if (file.get() < 0) throw_refused(folder, "written to", errno);
    struct stat status {};
    const bool taken =
        is_held(lock(file.get())) || (::fstat(file.get(), &status) == 0 && status.st_nlink == 0);
    if (taken) continue;  // a clean-up locked it first and removes it
    fd_ = file.release();
    return;
  }
}

UnfinishedFile::~UnfinishedFile() {
  if (fd_ < 0) return;
  ::unlink(path_.c_str());
  ::close(fd_);
}

void UnfinishedFile::append(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw_refused(path_.parent_path(), "written to", errno);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

void UnfinishedFile::finish(const fs::path& target) {
  if (::fsync(fd_) != 0) throw_refused(target, "written", errno);
  rename_to(target);
}

// Network file systems report failed writes at close(). Closing a duplicate keeps the lock.
void UnfinishedFile::finish_unsynced(const fs::path& target) {
  if (const int copy = ::dup(fd_); copy >= 0 && ::close(copy) != 0) throw_refused(target, "written", errno);
  rename_to(target);
}

void UnfinishedFile::rename_to(const fs::path& target) {
  if (std::rename(path_.c_str(), target.c_str()) != 0) throw_refused(target, "written", errno);
  ::close(std::exchange(fd_, -1));
}

void sync_file(const fs::path& path) {
  const Descriptor file(open_file(path, O_RDONLY));
  if (file.get() < 0 && is_missing(errno)) return;
  if (file.get() < 0 || ::fsync(file.get()) != 0) throw_refused(path, "written", errno);
}

void write_file(const fs::path& path, std::string_view text) {
  UnfinishedFile file(folder_of(path));
  file.append(std::as_bytes(std::span(text)));
  file.finish(path);
  sync_folder(folder_of(path));
}

void visit_abandoned(const fs::path& folder, const std::function<void(const fs::path&)>& visit) {
  for (const FolderEntry& entry : list_folder(folder)) {
    if (entry.is_folder || !entry.path.filename().string().ends_with(kUnfinished)) continue;
    const Descriptor file(open_file(entry.path, O_RDWR | O_NONBLOCK | O_NOFOLLOW));
    if (file.get() >= 0 && lock(file.get()) == 0) visit(entry.path);  // locked until it is removed
  }
}

bool is_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

void require_folder(const fs::path& path) {
  if (is_folder(path)) return;
  std::error_code error;
  if (fs::exists(path, error)) throw InputError(path.string() + ": is a file, where a folder is expected");
  const std::string start = path.is_relative() ? " in " + fs::current_path(error).string() : "";
  throw InputError(fmt::format("{}: there is no such folder{}", path.string(), start));
}

std::vector<FolderEntry> list_folder(const fs::path& folder) {
  std::vector<FolderEntry> entries;
  visit_names(folder, [&](std::string_view name, bool is_folder) {
    entries.push_back({folder / name, is_folder});
  });
  std::ranges::sort(
      entries, [](const FolderEntry& a, const FolderEntry& b) { return a.path.native() < b.path.native(); });
  return entries;
}

// Uses names relative to the open folder: for the tens of thousands of files of a cache, building and
// resolving paths takes nearly as long as all other work of the listing.
void visit_names(const fs::path& folder,
                 const std::function<void(std::string_view name, bool is_folder)>& visit) {
  const std::unique_ptr<DIR, int (*)(DIR*)> listed(::opendir(folder.c_str()), ::closedir);
  if (!listed && is_missing(errno)) return;
  if (!listed) throw_refused(folder, "listed", errno);
  for (errno = 0; const dirent* entry = ::readdir(listed.get()); errno = 0) {
    const std::string_view name = entry->d_name;
    if (name == "." || name == "..") continue;
    bool is_folder = entry->d_type == DT_DIR;
    if (entry->d_type == DT_LNK || entry->d_type == DT_UNKNOWN) {
      struct stat status {};
      const bool is_there = ::fstatat(::dirfd(listed.get()), entry->d_name, &status, 0) == 0;
      if (!is_there && !is_missing(errno) && errno != ELOOP) throw_refused(folder / name, "looked at", errno);
      is_folder = is_there && S_ISDIR(status.st_mode);
    }
    visit(name, is_folder);
  }
  if (errno != 0) throw_refused(folder, "listed", errno);
}

void make_folder(const fs::path& folder, std::string_view advice) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error)
    throw StorageError(
        fmt::format("{}: the folder cannot be created: {}; {}", folder.string(), error.message(), advice));
}

std::string lower_case_extension(const fs::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

void remove_file(const fs::path& path) {
  std::error_code error;
  fs::remove(path, error);
  if (error) throw_refused(path, "removed", error.value());
}

bool move_file(const fs::path& from, const fs::path& to) {
  return std::rename(from.c_str(), to.c_str()) == 0 || errno == ENOENT;
}

std::optional<std::uintmax_t> size_of_file(const fs::path& path) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(path, error);
  if (!error) return size;
  if (is_missing(error.value())) return {};
  throw_refused(path, "looked at", error.value());
}

}  // namespace salbench
