// SPDX-License-Identifier: GPL-3.0-or-later
// Progress of work in other threads, reported by the thread that started it.
#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/pybind11.h>

#include "stages/core/progress.h"

namespace salbench::python {

class Counts final : public Progress {
 public:
  void begin(const std::string& what, std::size_t items, std::function<std::string()> at_work) override;
  void item_done() override { ++done_; }
  void end() override;

  // Calls progress(part, items done, all items, jobs at work) for each part that ended since the last call,
  // then for the current one. Does nothing if `progress` is None.
  void tell(pybind11::handle progress);

 private:
  std::mutex mutex_;
  std::vector<std::pair<std::string, std::size_t>> ended_;  // since the last call, with their items
  std::string what_;
  std::function<std::string()> at_work_;
  std::size_t items_ = 0;
  std::atomic<std::size_t> done_ = 0;
};

// Runs `work` in a thread of its own, while this one handles signals and reports `progress`. After Ctrl-C the
// work is asked to stop, and KeyboardInterrupt is raised once it has.
void interruptible(pybind11::handle progress,
                   const std::function<void(Progress&, const std::atomic<bool>& stop)>& work);

}  // namespace salbench::python
