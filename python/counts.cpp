// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/counts.h"

#include <utility>

#include "python/caller.h"

namespace salbench::python {

namespace py = pybind11;

void Counts::begin(const std::string& what, std::size_t items, std::function<std::string()> at_work) {
  const std::lock_guard lock(mutex_);
  what_ = what;
  items_ = items;
  done_ = 0;
  at_work_ = std::move(at_work);
}

void Counts::end() {
  const std::lock_guard lock(mutex_);
  at_work_ = {};
  if (done_ == items_) ended_.emplace_back(what_, items_);
}

void Counts::tell(py::handle progress) {
  if (progress.is_none()) return;
  std::string what, now;
  std::size_t items = 0;
  std::vector<std::pair<std::string, std::size_t>> ended;
  {
    const std::lock_guard lock(mutex_);
    what = what_;
    items = items_;
    ended.swap(ended_);
    if (at_work_) now = at_work_();
  }
  for (const auto& [part, all] : ended) progress(part, all, all, "");
  progress(what, done_.load(), items, now);
}

void interruptible(py::handle progress,
                   const std::function<void(Progress&, const std::atomic<bool>& stop)>& work) {
  Caller caller;
  Counts counts;
  caller.run([&] { work(counts, caller.stop()); }, [&] { counts.tell(progress); });
}

}  // namespace salbench::python
