// Progress on standard error: a bar on a terminal, a plain line now and then elsewhere.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

namespace salbench {

class Progress {
 public:
  virtual ~Progress() = default;
  virtual void begin(const std::string& what, std::size_t items) = 0;
  virtual void item_done() = 0;  // from any thread
  virtual void end() = 0;
};

std::unique_ptr<Progress> terminal_progress();
std::unique_ptr<Progress> no_progress();

}  // namespace salbench
