// SPDX-License-Identifier: GPL-3.0-or-later
// As with unfinished files (file.cpp), whoever makes a folder locks it and checks that it is still there, and
// whoever removes an abandoned one locks it before: neither can take the other's.
#include "io/commands/scratch_folder.h"

#include <cerrno>
#include <string_view>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/file.h"
#include "stages/core/errors.h"

namespace salbench {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = "salbench-scratch-";

fs::path root() {
  std::error_code error;
  const fs::path given = fs::temp_directory_path(error);
  return error ? fs::path("/tmp") : fs::absolute(given);  // commands run in other folders
}

// True for the names that ScratchFolder gives and, in practice, for no folder of the user.
bool is_scratch_name(std::string_view name) {
  return name.starts_with(kPrefix) && name.size() == kPrefix.size() + kRandomDigits &&
         name.find_first_not_of("0123456789abcdef", kPrefix.size()) == std::string_view::npos;
}

int open_folder(const fs::path& path) {
  return ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
}

void remove_if_abandoned(const fs::path& path) {
  const Descriptor folder(open_folder(path));
  struct stat status {};
  if (folder.get() < 0 || ::fstat(folder.get(), &status) != 0 || status.st_uid != ::geteuid()) return;
  std::error_code ignored;
  if (::flock(folder.get(), LOCK_EX | LOCK_NB) == 0) fs::remove_all(path, ignored);
}

}  // namespace

ScratchFolder::ScratchFolder() {
  for (bool taken = true; taken;) {
    path_ = root() / fmt::format("{}{}", kPrefix, random_digits());
    if (::mkdir(path_.c_str(), 0700) != 0)
      throw StorageError(fmt::format("{}: the folder cannot be created: {}; set TMPDIR to another",
                                     path_.string(), system_reason(errno)));
    lock_ = Descriptor(open_folder(path_));
    if (lock_.get() < 0 && errno != ENOENT)
      throw StorageError(
          fmt::format("{}: the folder cannot be opened: {}", path_.string(), system_reason(errno)));
    // On a file system without locks nothing is taken, and nothing is found abandoned.
    const bool held = ::flock(lock_.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    taken = held || ::access(path_.c_str(), F_OK) != 0;
  }
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  if (::getpid() == owner_) fs::remove_all(path_, ignored);
}

std::string without_scratch_folders(std::string message) {
  const std::string start = (root() / kPrefix).string();
  for (std::size_t at = 0; (at = message.find(start, at)) != std::string::npos;) {
    const std::size_t name = at + start.size() - kPrefix.size(), end = message.find('/', name);
    if (end != std::string::npos && is_scratch_name(std::string_view(message).substr(name, end - name)))
      message.erase(at, end + 1 - at);
    else
      at += start.size();
  }
  return message;
}

void remove_abandoned_scratch() {
  std::error_code error;
  for (fs::directory_iterator it(root(), error), end; !error && it != end; it.increment(error))
    if (is_scratch_name(it->path().filename().native())) remove_if_abandoned(it->path());
}

}  // namespace salbench
