// Progress reports of a long loop.
#pragma once

#include <cstddef>
#include <string>

namespace salbench {

class Progress {
 public:
  virtual ~Progress() = default;
  virtual void begin(const std::string& what, std::size_t items) = 0;
  virtual void item_done() = 0;  // from any thread
  virtual void end() = 0;
};

class NoProgress final : public Progress {
 public:
  void begin(const std::string&, std::size_t) override {}
  void item_done() override {}
  void end() override {}
};

}  // namespace salbench
