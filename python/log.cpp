// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/log.h"

#include <atomic>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include <pthread.h>
#include <pybind11/pybind11.h>
#include <spdlog/sinks/sink.h>
#include <spdlog/spdlog.h>

namespace salbench::python {
namespace {

namespace py = pybind11;

struct Record {
  int level;  // Python's
  std::string text;
};

// What was said and not delivered yet.
class Kept {
 public:
  void add(Record record) {
    const std::lock_guard lock(mutex_);
    records_.push_back(std::move(record));
    any_ = true;
  }

  std::deque<Record> take() {
    if (!any_) return {};
    const std::lock_guard lock(mutex_);
    any_ = false;
    return std::exchange(records_, {});
  }

  // About a fork: nobody adds meanwhile, and the child does not say again what its parent will.
  void lock() { mutex_.lock(); }
  void unlock() { mutex_.unlock(); }
  void unlock_in_child() {
    records_.clear();
    any_ = false;
    mutex_.unlock();
  }

 private:
  std::mutex mutex_;
  std::deque<Record> records_;
  std::atomic<bool> any_ = false;
};

// Never destroyed: threads may speak until the process ends.
Kept& kept() {
  static auto* const all = new Kept;
  return *all;
}

int python_level(spdlog::level::level_enum level) {
  switch (level) {
    case spdlog::level::critical:
      return 50;
    case spdlog::level::err:
      return 40;
    case spdlog::level::warn:
      return 30;
    case spdlog::level::info:
      return 20;
    default:
      return 10;
  }
}

class Sink final : public spdlog::sinks::sink {
 public:
  void log(const spdlog::details::log_msg& message) override {
    kept().add({python_level(message.level), {message.payload.data(), message.payload.size()}});
  }
  void flush() override {}
  void set_pattern(const std::string&) override {}  // logging has formats of its own
  void set_formatter(std::unique_ptr<spdlog::formatter>) override {}
};

py::str text_of(const std::string& bytes) {
  return py::reinterpret_steal<py::str>(
      PyUnicode_DecodeUTF8(bytes.data(), static_cast<py::ssize_t>(bytes.size()), "backslashreplace"));
}

}  // namespace

void keep_log() {
  pthread_atfork([] { kept().lock(); }, [] { kept().unlock(); }, [] { kept().unlock_in_child(); });
  spdlog::set_default_logger(std::make_shared<spdlog::logger>("salbench", std::make_shared<Sink>()));
}

void deliver_log() {
  const std::deque<Record> records = kept().take();
  if (records.empty()) return;
  const py::error_scope pending;  // kept for whoever raised it
  try {
    const py::object log = py::module_::import("logging").attr("getLogger")("salbench").attr("log");
    for (const Record& record : records) log(record.level, "%s", text_of(record.text));
  } catch (py::error_already_set& error) {  // a filter of the user's
    if (error.matches(PyExc_KeyboardInterrupt))
      PyErr_SetInterrupt();
    else
      error.discard_as_unraisable("salbench: a record of the log");
  }
}

}  // namespace salbench::python
