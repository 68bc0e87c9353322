// SPDX-License-Identifier: GPL-3.0-or-later
// Meeting point of threads, for tests of concurrency.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>

namespace salbench {

class Meeting {
 public:
  // The timeout only limits failing tests; a passing one does not wait for it.
  explicit Meeting(int expected, std::chrono::milliseconds patience = std::chrono::minutes(5))
      : expected_(expected), patience_(patience) {}

  // Waits for the others. True if all were present at once; false for everybody after one timed out.
  bool join() {
    std::unique_lock lock(mutex_);
    if (++present_ == expected_ && !failed_) met_ = true;
    changed_.notify_all();
    failed_ |= !changed_.wait_for(lock, patience_, [&] { return met_ || failed_; });
    return met_;
  }
  bool met() const {
    const std::lock_guard lock(mutex_);
    return met_;
  }

 private:
  const int expected_;
  const std::chrono::milliseconds patience_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  int present_ = 0;
  bool met_ = false, failed_ = false;
};

}  // namespace salbench
