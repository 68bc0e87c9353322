// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/log.h"

#include <algorithm>
#include <atomic>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include <pthread.h>
#include <pybind11/pybind11.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>

namespace salbench::python {
namespace {

namespace py = pybind11;

struct Record {
  int level;  // as in Python's logging
  std::string text;
};

int python_level(spdlog::level::level_enum level) { return 10 * std::max(1, static_cast<int>(level)); }

// Messages not yet delivered.
class Kept final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  std::deque<Record> take() {
    if (!any_) return {};
    const std::lock_guard lock(mutex_);
    any_ = false;
    return std::exchange(records_, {});
  }

  // Called around fork(): nothing is added meanwhile, and the child drops messages that its parent delivers.
  void lock() { mutex_.lock(); }
  void unlock() { mutex_.unlock(); }
  void unlock_in_child() {
    records_.clear();
    any_ = false;
    mutex_.unlock();
  }

 private:
  void sink_it_(const spdlog::details::log_msg& message) override {
    records_.push_back({python_level(message.level), {message.payload.data(), message.payload.size()}});
    any_ = true;
  }
  void flush_() override {}

  std::deque<Record> records_;
  std::atomic<bool> any_ = false;
};

// Never destroyed: threads may log until the process ends.
const std::shared_ptr<Kept>& kept() {
  static const auto* const sink = new std::shared_ptr<Kept>(std::make_shared<Kept>());
  return *sink;
}

int raise_interrupt(void*) {
  PyErr_SetNone(PyExc_KeyboardInterrupt);
  return -1;
}

py::str text_of(const std::string& bytes) {
  return py::reinterpret_steal<py::str>(
      PyUnicode_DecodeUTF8(bytes.data(), static_cast<py::ssize_t>(bytes.size()), "backslashreplace"));
}

}  // namespace

void keep_log() {
  pthread_atfork([] { kept()->lock(); }, [] { kept()->unlock(); }, [] { kept()->unlock_in_child(); });
  spdlog::set_default_logger(std::make_shared<spdlog::logger>("salbench", kept()));
}

void deliver_log() {
  const std::deque<Record> records = kept()->take();
  if (records.empty()) return;
  const py::error_scope pending;  // saved and restored
  for (const Record& record : records) try {
      const py::object log = py::module_::import("logging").attr("getLogger")("salbench").attr("log");
      log(record.level, "%s", text_of(record.text));
    } catch (py::error_already_set& error) {  // from a user's filter
      if (error.matches(PyExc_KeyboardInterrupt))
        Py_AddPendingCall(raise_interrupt,
                          nullptr);  // raising the signal again may end the process by now
      else
        error.discard_as_unraisable("salbench: a record of the log");
    }
}

}  // namespace salbench::python
