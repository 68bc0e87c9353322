// SPDX-License-Identifier: GPL-3.0-or-later
#include <chrono>
#include <cmath>
#include <cstdio>
#include <mutex>

#include <fmt/format.h>
#include <unistd.h>

#include "pipeline/commands/session.h"

namespace salbench {
namespace {

using Clock = std::chrono::steady_clock;

std::string duration_text(double seconds) {
  const auto whole = std::lround(seconds);
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

class TerminalProgress final : public Progress {
 public:
  TerminalProgress() : on_terminal_(::isatty(STDERR_FILENO) != 0) {}

  void begin(const std::string& what, std::size_t items, std::function<std::string()> at_work) override {
    const std::lock_guard lock(mutex_);
    at_work_ = std::move(at_work);
    what_ = what;
    items_ = items;
    done_ = 0;
    started_ = shown_ = Clock::now();
  }

  void item_done() override {
    const std::lock_guard lock(mutex_);
    ++done_;
    const auto now = Clock::now();
    if (now - shown_ < interval() && done_ != items_) return;
    shown_ = now;
    show(std::chrono::duration<double>(now - started_).count());
  }

  void end() override {
    const std::lock_guard lock(mutex_);
    if (on_terminal_ && done_ > 0) std::fputc('\n', stderr);
    at_work_ = {};
  }

 private:
  Clock::duration interval() const {
    return on_terminal_ ? std::chrono::milliseconds(100) : std::chrono::seconds(10);
  }

  void show(double elapsed) const {
    const double rate = static_cast<double>(done_) / std::max(elapsed, 1e-3);
    const std::string left = duration_text(static_cast<double>(items_ - done_) / rate);
    const std::string now = at_work_ ? at_work_() : "";
    const char* unit = at_work_ ? "jobs" : "items";
    std::string text = fmt::format("{}: {}/{} {}, {:.1f} {}/s, {} left{}{}", what_, done_, items_, unit, rate,
                                   unit, left, now.empty() ? "" : "; now ", now);
    if (on_terminal_) {
      constexpr std::size_t kWidth = 24;
      const std::size_t filled = items_ == 0 ? kWidth : done_ * kWidth / items_;
      text = fmt::format("\r[{:-<{}}{: <{}}] {}\033[K", "", filled, "", kWidth - filled, text);
    } else {
      text += '\n';
    }
    std::fputs(text.c_str(), stderr);  // fmt::print throws if standard error takes no text
    std::fflush(stderr);
  }

  bool on_terminal_;
  std::mutex mutex_;
  std::string what_;
  std::function<std::string()> at_work_;
  std::size_t items_ = 0, done_ = 0;
  Clock::time_point started_, shown_;
};

}  // namespace

std::unique_ptr<Progress> progress_of(bool quiet) {
  if (quiet) return std::make_unique<NoProgress>();
  return std::make_unique<TerminalProgress>();
}

}  // namespace salbench
