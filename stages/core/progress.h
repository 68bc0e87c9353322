// SPDX-License-Identifier: GPL-3.0-or-later
// Progress reports of a long loop.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace salbench {

class Progress {
 public:
  virtual ~Progress() = default;
  // `at_work` describes the current work; it may be called from any thread until end().
  virtual void begin(const std::string& what, std::size_t items,
                     std::function<std::string()> at_work = {}) = 0;
  virtual void item_done() = 0;  // thread-safe
  virtual void end() = 0;
};

class NoProgress final : public Progress {
 public:
  void begin(const std::string&, std::size_t, std::function<std::string()>) override {}
  void item_done() override {}
  void end() override {}
};

}  // namespace salbench
