// SPDX-License-Identifier: GPL-3.0-or-later
// A claim is a lock on a single byte of one empty file; the digest of the work's name selects the byte.
// A claim writes nothing and needs no clean-up. The locks belong to the open file (F_OFD_SETLK), not to the
// process: they hold between threads too, and closing another descriptor of the file keeps them. A child
// process inherits the open file, and would hold the lock for its lifetime if claims were not given back.
#include "cache/claim.h"

#include <cerrno>
#include <limits>

#include <fcntl.h>
#include <unistd.h>

#include "cache/layout.h"
#include "io/digest.h"

namespace salbench {
namespace {

class LockedByte final : public Claim {
 public:
  explicit LockedByte(int fd) : fd_(fd) {}
  ~LockedByte() override {
    if (fd_ < 0) return;
    struct flock all {};
    all.l_type = F_UNLCK;
    all.l_whence = SEEK_SET;
    ::fcntl(fd_, F_OFD_SETLK, &all);
    ::close(fd_);
  }
  int fd() const { return fd_; }

 private:
  int fd_;
};

off_t byte_of(std::string_view work) {
  Hasher hasher;
  hasher.add(work);
  return static_cast<off_t>(hasher.digest().low & (std::numeric_limits<off_t>::max() >> 1));
}

// Lock that claims the work.
struct flock lock_of(std::string_view work) {
  struct flock lock {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  lock.l_start = byte_of(work);
  lock.l_len = 1;
  return lock;
}

}  // namespace

std::unique_ptr<Claim> claim_in(const std::filesystem::path& cache, std::string_view work) {
  const int fd = ::open((cache / kClaimsFile).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  auto claim = std::make_unique<LockedByte>(fd);
  struct flock lock = lock_of(work);
  const bool taken = fd >= 0 && ::fcntl(fd, F_OFD_SETLK, &lock) != 0 && (errno == EAGAIN || errno == EACCES);
  if (taken) return nullptr;
  return claim;
}

bool is_claimed_in(const std::filesystem::path& cache, std::string_view work) {
  const LockedByte file(::open((cache / kClaimsFile).c_str(), O_RDONLY | O_CLOEXEC));
  struct flock lock = lock_of(work);
  return file.fd() >= 0 && ::fcntl(file.fd(), F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
}

}  // namespace salbench
