// SPDX-License-Identifier: GPL-3.0-or-later
// How far work has come, for the thread that called it.
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

  // Calls `progress` with what is done, how much of it, of how much, and what is at work: of parts that have
  // ended since, then of the present one. None is not called.
  void tell(pybind11::handle progress);

 private:
  std::mutex mutex_;
  std::vector<std::pair<std::string, std::size_t>> ended_;  // and how much was done of each
  std::string what_;
  std::function<std::string()> at_work_;
  std::size_t items_ = 0;
  std::atomic<std::size_t> done_ = 0;
};

// `work` in a thread of its own, while this one looks at signals and tells `progress`. After Ctrl-C it is
// asked to stop, and the KeyboardInterrupt is raised when it has.
void interruptible(pybind11::handle progress,
                   const std::function<void(Progress&, const std::atomic<bool>& stop)>& work);

}  // namespace salbench::python
